// The crossing of a line and a triangle as signs of polynomials, in two kinds of numbers.
//
// With the corners a, b, c relative to the origin and n = (b - a) x (c - a):
//
//   the weights   d . (b x c),  d . (c x a),  d . (a x b)   sum to   d . n,
//   and           t = a . (b x c) / d . n.
//
// The line crosses the triangle if d . n is not 0 and no weight has the opposite sign.
#include "cpu_ref/exact_truth.h"

#include <tuple>

#include "cpu_ref/dyadic.h"

namespace onepass {

namespace {

template <class Number>
struct Vector {
    Number x, y, z;
};

template <class Number>
Vector<Number> operator-(const Vector<Number>& a, const Vector<Number>& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class Number>
Number dot(const Vector<Number>& a, const Vector<Number>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class Number>
Vector<Number> cross(const Vector<Number>& a, const Vector<Number>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Every double is a number of either kind, exactly.
template <class Number>
Vector<Number> exactly(const dvec3& v) {
    return {Number(v.x), Number(v.y), Number(v.z)};
}

template <class Number>
struct Triangle {
    Vector<Number> a, b, c;
};

/// The real corners in the world: world_from_object applied without rounding.
template <class Number>
Triangle<Number> world_triangle(const Scene& scene, uint32_t inst_id, uint32_t prim_id) {
    const Instance& instance = scene.instances[inst_id];
    const Object& object = scene.objects[instance.object];
    const uvec3 corners = object.triangles[prim_id];
    const Affine& m = instance.world_from_object;
    const bool identity = m == affine_identity();
    const auto corner = [&](uint32_t index) {
        const Vector<Number> p = exactly<Number>(dvec3(object.positions[index]));
        if (identity) return p;
        const auto row = [&](int k) -> Number {
            return Number(double{m[0][k]}) * p.x + Number(double{m[1][k]}) * p.y +
                   Number(double{m[2][k]}) * p.z + Number(double{m[3][k]});
        };
        return Vector<Number>{row(0), row(1), row(2)};
    };
    return {corner(corners.x), corner(corners.y), corner(corners.z)};
}

/// The polynomials of a line and a triangle.
template <class Number>
struct Form {
    std::array<Number, 3> weights;  ///< of a, b, c, times d . n
    Number volume;                  ///< d . n
    Number height;                  ///< t times d . n
};

template <class Number>
Form<Number> form_of(const Scene& scene, const SpreadRay& ray, uint32_t inst_id, uint32_t prim_id) {
    const Vector<Number> org = exactly<Number>(ray.org);
    const Vector<Number> dir = exactly<Number>(ray.dir);
    const Triangle<Number> world = world_triangle<Number>(scene, inst_id, prim_id);
    const Vector<Number> a = world.a - org;
    const Vector<Number> b = world.b - org;
    const Vector<Number> c = world.c - org;
    const Vector<Number> bc = cross(b, c);
    Form<Number> form;
    form.weights = {dot(dir, bc), dot(dir, cross(c, a)), dot(dir, cross(a, b))};
    form.volume = form.weights[0] + form.weights[1] + form.weights[2];
    form.height = dot(a, bc);
    return form;
}

/// Whether the line crosses; nothing where the numbers cannot tell.
template <class Number>
std::optional<bool> crosses(const Form<Number>& form) {
    std::array<std::optional<int>, 3> signs;
    for (int i = 0; i < 3; ++i) signs[i] = sign_of(form.weights[i]);
    const auto any = [&](int sign) {
        return signs[0] == sign || signs[1] == sign || signs[2] == sign;
    };
    if (any(1) && any(-1)) return false;
    for (const auto& sign : signs) {
        if (!sign) return std::nullopt;
    }
    return any(1) || any(-1);  // all 0: the line lies in the plane, or there is no area
}

/// The real t of a line that crosses: a fraction with a positive denominator.
struct ExactT {
    Dyadic height;
    Dyadic volume;
};

ExactT exact_t(const Scene& scene, const SpreadRay& ray, const ExactHit& hit) {
    const Form<Dyadic> form = form_of<Dyadic>(scene, ray, hit.inst_id, hit.prim_id);
    if (sign_of(form.volume) == 1) return {form.height, form.volume};
    return {-form.height, -form.volume};
}

/// -1, 0 or 1 as a < b, a = b or a > b.
int compare(const ExactT& a, const ExactT& b) {
    return *sign_of(a.height * b.volume - b.height * a.volume);
}

double rounded(const Dyadic& above, const Dyadic& below) {
    using boost::multiprecision::cpp_rational;
    const cpp_rational quotient(above.mantissa, below.mantissa);
    return std::ldexp(quotient.convert_to<double>(), above.exponent - below.exponent);
}
double rounded(const ExactT& t) { return rounded(t.height, t.volume); }

/// The quotient in decimal, cut after kDetailDigits significant digits: "0.5", "1.333...e-7"
/// without the dots.
std::string decimal(const Dyadic& above, const Dyadic& below) {
    using boost::multiprecision::cpp_int;
    if (above.mantissa.is_zero()) return "0";
    const bool negative = above.mantissa.sign() != below.mantissa.sign();
    cpp_int numerator = abs(above.mantissa);
    cpp_int denominator = abs(below.mantissa);
    const int shift = above.exponent - below.exponent;
    (shift > 0 ? numerator : denominator) <<= std::abs(shift);

    // digits = floor(quotient * 10^(kDetailDigits - 1 - exponent)), of just so many digits.
    const auto scaled = [&](int exponent) {
        const int power = kDetailDigits - 1 - exponent;
        const cpp_int factor = pow(cpp_int(10), static_cast<unsigned>(std::abs(power)));
        return power >= 0 ? cpp_int(numerator * factor / denominator)
                          : cpp_int(numerator / (denominator * factor));
    };
    int exponent = static_cast<int>(std::floor(std::log10(std::abs(rounded(above, below)))));
    std::string digits = scaled(exponent).str();
    while (digits.size() != static_cast<size_t>(kDetailDigits)) {  // log10 was rounded
        exponent += digits.size() > static_cast<size_t>(kDetailDigits) ? 1 : -1;
        digits = scaled(exponent).str();
    }
    digits.erase(digits.find_last_not_of('0') + 1);

    // Small exponents without an "e".
    std::string text;
    const auto count = static_cast<int>(digits.size());
    if (exponent < -4 || exponent >= kDetailDigits) {
        text = digits.substr(0, 1) + (count > 1 ? "." + digits.substr(1) : "") + "e" +
               std::to_string(exponent);
    } else if (exponent < 0) {
        text = "0." + std::string(static_cast<size_t>(-exponent - 1), '0') + digits;
    } else {
        const auto whole = static_cast<size_t>(exponent) + 1;
        if (digits.size() < whole) digits.resize(whole, '0');
        text = digits.substr(0, whole) + (digits.size() > whole ? "." + digits.substr(whole) : "");
    }
    return (negative ? "-" : "") + text;
}

/// How near t_rounded is to the real t, relative to it: far below a float's 2^-24.
constexpr double kRoundedWithin = 0x1p-40;

/// The hit of a line that crosses, its t as an interval or, where that is too wide, rounded from
/// the exact one.
ExactHit hit_of(const Scene& scene, const SpreadRay& ray, uint32_t inst_id, uint32_t prim_id,
                const Form<Interval>& form) {
    ExactHit hit{.inst_id = inst_id, .prim_id = prim_id, .t = {}, .t_rounded = 0.0};
    const std::optional<int> volume_sign = sign_of(form.volume);
    if (volume_sign && *volume_sign != 0) {
        hit.t = form.height / form.volume;
        hit.t_rounded = hit.t.middle();
        if (hit.t.upper - hit.t.lower <= kRoundedWithin * std::abs(hit.t_rounded)) return hit;
    }
    hit.t_rounded = rounded(exact_t(scene, ray, hit));
    // The conversion is to nearest, or at least to one of the two neighbours.
    hit.t = widened(hit.t_rounded, hit.t_rounded);
    return hit;
}

bool has_lower_ids(const ExactHit& a, const ExactHit& b) {
    return std::tie(a.inst_id, a.prim_id) < std::tie(b.inst_id, b.prim_id);
}

Surface as_surface(const ExactHit& hit) {
    return {.inst_id = hit.inst_id,
            .prim_id = hit.prim_id,
            .crossing = {.t = hit.t_rounded,
                         .t_tolerance = kRoundedWithin * std::abs(hit.t_rounded),
                         .touch = false},
            .optional = hit.at_interval_end};
}

}  // namespace

std::optional<ExactHit> ExactTruth::crossing(const SpreadRay& ray, uint32_t inst_id,
                                             uint32_t prim_id) const {
    const Form<Interval> form = form_of<Interval>(scene(), ray, inst_id, prim_id);
    std::optional<bool> decided = crosses(form);
    if (!decided) decided = crosses(form_of<Dyadic>(scene(), ray, inst_id, prim_id));
    if (!*decided) return {};
    return hit_of(scene(), ray, inst_id, prim_id, form);
}

ExactDetail ExactTruth::detail(const SpreadRay& ray, uint32_t inst_id, uint32_t prim_id) const {
    const Form<Dyadic> form = form_of<Dyadic>(scene(), ray, inst_id, prim_id);
    ExactDetail detail;
    detail.crosses = *crosses(form);
    detail.close = !crosses(form_of<Interval>(scene(), ray, inst_id, prim_id));
    for (const Dyadic& weight : form.weights) {
        detail.on_edge |= detail.crosses && *sign_of(weight) == 0;
    }
    detail.has_t = *sign_of(form.volume) != 0;
    if (!detail.has_t) return detail;
    detail.t = rounded(form.height, form.volume);
    detail.u = rounded(form.weights[1], form.volume);
    detail.v = rounded(form.weights[2], form.volume);
    detail.t_digits = decimal(form.height, form.volume);
    return detail;
}

double ExactTruth::distance(const SpreadRay& ray, const ExactHit& a, const ExactHit& b) const {
    const ExactT ta = exact_t(scene(), ray, a);
    const ExactT tb = exact_t(scene(), ray, b);
    return rounded(tb.height * ta.volume - ta.height * tb.volume, ta.volume * tb.volume);
}

int ExactTruth::compare_t(const SpreadRay& ray, const ExactHit& a, const ExactHit& b) const {
    if (a.t.upper < b.t.lower) return -1;
    if (b.t.upper < a.t.lower) return 1;
    return compare(exact_t(scene(), ray, a), exact_t(scene(), ray, b));
}

int ExactTruth::compare_t(const SpreadRay& ray, const ExactHit& a, double b) const {
    if (a.t.upper < b || b == std::numeric_limits<double>::infinity()) return -1;
    if (a.t.lower > b) return 1;
    return compare(exact_t(scene(), ray, a), {Dyadic(b), Dyadic(1.0)});
}

std::optional<ExactHit> ExactTruth::hit_in_interval(const SpreadRay& ray, uint32_t inst_id,
                                                    uint32_t prim_id) const {
    std::optional<ExactHit> hit = crossing(ray, inst_id, prim_id);
    if (!hit) return {};
    const int after_tmin = compare_t(ray, *hit, ray.tmin);
    const int after_tmax = compare_t(ray, *hit, ray.tmax);
    if (after_tmin < 0 || after_tmax > 0) return {};
    hit->at_interval_end = after_tmin == 0 || after_tmax == 0;
    return hit;
}

Truth ExactTruth::find(const SpreadRay& ray) const {
    // Collect what is not behind the nearest hit strictly inside the interval.
    std::vector<ExactHit> found;
    double firm_t = std::numeric_limits<double>::infinity();  // not below that hit's real t
    candidates_.visit(ray, [&](uint32_t inst_id, uint32_t prim_id) {
        const double farthest = std::min(ray.tmax, firm_t);
        const std::optional<ExactHit> hit = hit_in_interval(ray, inst_id, prim_id);
        if (!hit || hit->t.lower > farthest) return farthest;
        if (!hit->at_interval_end) firm_t = std::min(firm_t, hit->t.upper);
        found.push_back(*hit);
        return std::min(farthest, firm_t);
    });

    // The nearest of all, and the nearest strictly inside.
    std::sort(found.begin(), found.end(), has_lower_ids);
    const ExactHit* nearest = nullptr;
    const ExactHit* nearest_inside = nullptr;
    for (const ExactHit& hit : found) {
        if (!nearest || compare_t(ray, hit, *nearest) < 0) nearest = &hit;
        if (hit.at_interval_end) continue;
        if (!nearest_inside || compare_t(ray, hit, *nearest_inside) < 0) nearest_inside = &hit;
    }
    Truth truth;
    truth.miss_is_right = nearest_inside == nullptr;
    if (nearest) truth.nearest = as_surface(*nearest);
    for (const ExactHit& hit : found) {
        if (nearest_inside && compare_t(ray, hit, *nearest_inside) > 0) continue;
        truth.right.push_back(as_surface(hit));
    }
    return truth;
}

std::vector<ExactHit> ExactTruth::find_all(const SpreadRay& ray) const {
    std::vector<ExactHit> found;
    candidates_.visit(ray, [&](uint32_t inst_id, uint32_t prim_id) {
        const std::optional<ExactHit> hit = hit_in_interval(ray, inst_id, prim_id);
        if (hit) found.push_back(*hit);
        return ray.tmax;
    });
    std::sort(found.begin(), found.end(), [&](const ExactHit& a, const ExactHit& b) {
        const int order = compare_t(ray, a, b);
        return order != 0 ? order < 0 : has_lower_ids(a, b);
    });
    return found;
}

}  // namespace onepass
