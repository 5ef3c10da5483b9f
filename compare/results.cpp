// JSON both ways. Each struct lists its fields once, in a `fields` function; Writer and Reader walk
// the same list, so that what is written is what is read.
#include "compare/results.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <set>
#include <type_traits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/atomic_file.h"
#include "compare/hash.h"
#include "core/error.h"

namespace onepass {
namespace {

using json = nlohmann::ordered_json;
namespace fs = std::filesystem;

// The fields, in the order in which they are written.

template <class A>
void fields(A& a, Manifest& m) {
    a("arguments", m.arguments), a("time_utc", m.time_utc), a("commit", m.commit);
    a("dirty", m.dirty), a("program_hash", m.program_hash);
    a("build_type", m.build_type), a("compiler", m.compiler);
    a("cpu", m.cpu), a("cores", m.cores), a("gl_context", m.gl_context);
    a("gl_renderer", m.gl_renderer), a("gl_version", m.gl_version);
    a("software_renderer", m.software_renderer), a("embree", m.embree), a("judge", m.judge);
    a("seed", m.seed), a("complete", m.complete);
}

template <class A>
void fields(A& a, SceneRecord& s) {
    a("name", s.name), a("triangles", s.triangles), a("unique_triangles", s.unique_triangles);
    a("instances", s.instances), a("lights", s.lights), a("hash", s.hash), a("notes", s.notes);
}

template <class A>
void fields(A& a, Stat& s) {
    a("name", s.name), a("value", s.value), a("note", s.note);
}

template <class A>
void fields(A& a, Deviation& d) {
    a("id", d.id), a("param", d.param), a("value", d.value), a("summary", d.summary);
}

template <class A>
void fields(A& a, TracerRecord& t) {
    a("scene", t.scene), a("name", t.name), a("params", t.params);
    a("sizing", t.sizing), a("device", t.device);
    a("software_renderer", t.software_renderer), a("is_oracle", t.is_oracle);
    a("is_twin", t.is_twin), a("threads", t.threads), a("shader_hash", t.shader_hash);
    a("stats", t.stats), a("deviations", t.deviations);
}

template <class A>
void fields(A& a, Ray& r) {
    a("org", r.org), a("tmin", r.tmin), a("dir", r.dir), a("tmax", r.tmax);
}

template <class A>
void fields(A& a, Hit& h) {
    a("t", h.t), a("u", h.u), a("v", h.v), a("prim_id", h.prim_id), a("inst_id", h.inst_id);
}

template <class A>
void fields(A& a, Verdict& v) {
    a("hit_class", v.hit_class), a("true_t", v.true_t), a("true_prim_id", v.true_prim_id);
    a("true_inst_id", v.true_inst_id), a("t_error_ulps", v.t_error_ulps);
    a("backward_error", v.backward_error);
}

template <class A>
void fields(A& a, WorstRay& w) {
    a("index", w.index), a("ray", w.ray), a("answer", w.answer), a("oracle", w.oracle);
    a("verdict", w.verdict);
}

template <class A>
void fields(A& a, ClassTally& t) {
    a("count", t.count), a("worst", t.worst);
}

template <class A>
void fields(A& a, std::pair<std::string, uint64_t>& attributed) {
    a("deviation", attributed.first), a("rays", attributed.second);
}

template <class A>
void fields(A& a, CheckRecord::Attribution& t) {
    a("asked", t.asked), a("by_deviation", t.by_deviation), a("unattributed", t.unattributed);
}

template <class A>
void fields(A& a, CheckRecord& c) {
    a("scene", c.scene), a("rays", c.rays), a("ray_hash", c.ray_hash);
    a("ray_count", c.ray_count), a("tracer", c.tracer), a("oracle", c.oracle);
    a("judge", c.judge), a("classes", c.classes), a("oracle_classes", c.oracle_classes);
    a("judged", c.judged), a("wrong_triangle", c.wrong_triangle), a("hit_count", c.hit_count);
    a("oracle_invalid", c.oracle_invalid), a("exhausted", c.exhausted), a("allowed", c.allowed);
    a("passed", c.passed), a("reference", c.reference), a("picture", c.picture);
    a("attribution", c.attribution);
}

template <class A>
void fields(A& a, std::pair<std::string, std::string>& picture) {
    a("role", picture.first), a("file", picture.second);
}

template <class A>
void fields(A& a, ImageRecord& i) {
    a("scene", i.scene), a("tracer", i.tracer), a("oracle", i.oracle), a("width", i.width);
    a("height", i.height), a("rmse", i.rmse), a("psnr_db", i.psnr_db);
    a("max_difference", i.max_difference), a("max_x", i.max_x), a("max_y", i.max_y);
    a("differing_pixels", i.differing_pixels), a("tolerance", i.tolerance);
    a("allowed_pixels", i.allowed_pixels), a("reason", i.reason), a("passed", i.passed);
    a("rays_per_pixel", i.rays_per_pixel), a("cells_full_scale", i.cells_full_scale);
    a("pictures", i.pictures);
}

template <class A>
void fields(A& a, CastCounts& c) {
    a("cells", c.cells), a("tests", c.tests), a("references", c.references);
    a("walked_rays", c.walked_rays), a("walked_tests", c.walked_tests);
    a("repeated_tests", c.repeated_tests);
}

template <class A>
void fields(A& a, TimingRecord& t) {
    a("scene", t.scene), a("rays", t.rays), a("ray_count", t.ray_count), a("tracer", t.tracer);
    a("oracle", t.oracle), a("wall_ms", t.wall_ms), a("device_ms", t.device_ms);
    a("oracle_wall_ms", t.oracle_wall_ms), a("median_ms", t.median_ms);
    a("mrays_per_s", t.mrays_per_s), a("ratio", t.ratio), a("ratio_low", t.ratio_low);
    a("ratio_high", t.ratio_high), a("errors", t.errors), a("edges", t.edges);
    a("again_wall_ms", t.again_wall_ms), a("again_device_ms", t.again_device_ms);
    a("counts", t.counts);
}

template <class A>
void fields(A& a, BuildRecord& b) {
    a("scene", b.scene), a("tracer", b.tracer), a("build_ms", b.build_ms);
}

template <class A>
void fields(A& a, FrameTimingRecord& f) {
    a("scene", f.scene), a("tracer", f.tracer), a("oracle", f.oracle), a("setting", f.setting);
    a("width", f.width), a("height", f.height), a("frames", f.frames),
        a("primary_rays", f.primary_rays);
    a("secondary_rays", f.secondary_rays), a("wall_ms", f.wall_ms);
    a("device_ms", f.device_ms), a("update_ms", f.update_ms), a("upload_ms", f.upload_ms);
    a("oracle_wall_ms", f.oracle_wall_ms), a("costs", f.costs), a("median_ms", f.median_ms);
    a("frames_per_s", f.frames_per_s), a("ratio", f.ratio), a("ratio_low", f.ratio_low);
    a("ratio_high", f.ratio_high), a("differing_pixels", f.differing_pixels);
    a("compared_pixels", f.compared_pixels);
}

template <class A>
void fields(A& a, ClaimMeasurement& m) {
    a("scene", m.scene), a("work", m.work), a("quantity", m.quantity), a("unit", m.unit);
    a("baseline", m.baseline), a("variant", m.variant), a("size", m.size);
    a("baseline_samples", m.baseline_samples), a("variant_samples", m.variant_samples);
    a("again_samples", m.again_samples), a("ratio", m.ratio), a("ratio_low", m.ratio_low);
    a("ratio_high", m.ratio_high), a("noise", m.noise), a("expectation", m.expectation);
    a("bound", m.bound), a("verdict", m.verdict), a("rays", m.rays);
    a("baseline_errors", m.baseline_errors), a("variant_errors", m.variant_errors);
    a("failure", m.failure);
}

template <class A>
void fields(A& a, ClaimRecord& c) {
    a("id", c.id), a("entry", c.entry), a("claim", c.claim), a("source", c.source);
    a("then", c.then), a("rule", c.rule), a("now", c.now), a("command", c.command);
    a("verdict", c.verdict), a("measurements", c.measurements);
}

template <class A>
void fields(A& a, SweepPoint& p) {
    a("scene", p.scene), a("rays", p.rays), a("tracer", p.tracer);
    a("top_density", p.top_density), a("object_density", p.object_density);
    a("resolution", p.resolution), a("sizes", p.sizes), a("chosen", p.chosen);
    a("ray_count", p.ray_count);
    a("cells", p.cells), a("references", p.references), a("bytes", p.bytes);
    a("build_ms", p.build_ms), a("cells_per_ray", p.cells_per_ray);
    a("tests_per_ray", p.tests_per_ray), a("errors", p.errors), a("failure", p.failure);
    a("wall_ms", p.wall_ms), a("device_ms", p.device_ms);
    a("oracle_wall_ms", p.oracle_wall_ms), a("ratio", p.ratio), a("ratio_low", p.ratio_low);
    a("ratio_high", p.ratio_high);
}

template <class A>
void fields(A& a, FailureCount& f) {
    a("kind", f.kind), a("count", f.count);
}

template <class A>
void fields(A& a, RungRecord& r) {
    a("knob", r.knob), a("label", r.label), a("tracer", r.tracer), a("setting", r.setting);
    a("trials", r.trials), a("ties", r.ties), a("edges", r.edges), a("failures", r.failures);
    a("refusal", r.refusal), a("worst", r.worst);
}

template <class A>
void fields(A& a, LadderRecord& l) {
    a("id", l.id), a("title", l.title), a("question", l.question), a("knob", l.knob);
    a("unit", l.unit), a("log_axis", l.log_axis), a("judge", l.judge), a("command", l.command);
    a("rungs", l.rungs);
}

template <class A>
void fields(A& a, TradeoffPoint& p) {
    a("scene", p.scene), a("rays", p.rays), a("tracer", p.tracer), a("setting", p.setting);
    a("oracle", p.oracle), a("ray_count", p.ray_count), a("errors", p.errors);
    a("edges", p.edges), a("wall_ms", p.wall_ms), a("oracle_wall_ms", p.oracle_wall_ms);
    a("ratio", p.ratio), a("ratio_low", p.ratio_low), a("ratio_high", p.ratio_high);
}

template <class A>
void fields(A& a, ClockReading& c) {
    a("sm_mhz", c.sm_mhz), a("memory_mhz", c.memory_mhz), a("temperature_c", c.temperature_c);
}

template <class A>
void fields(A& a, PaceRecord& p) {
    a("scene", p.scene), a("rays", p.rays), a("ray_count", p.ray_count);
    a("warm_up_rounds", p.warm_up_rounds), a("warm_up_ms", p.warm_up_ms), a("change", p.change);
    a("steady", p.steady), a("clocks_of", p.clocks_of), a("before", p.before);
    a("after", p.after);
}

template <class A>
void fields(A& a, GrowthBuild& g) {
    a("scene", g.scene), a("triangles", g.triangles), a("tracer", g.tracer);
    a("setting", g.setting), a("build_ms", g.build_ms), a("bytes", g.bytes);
    a("cells", g.cells), a("references", g.references), a("failure", g.failure);
}

template <class A>
void fields(A& a, GrowthTrace& g) {
    a("scene", g.scene), a("triangles", g.triangles), a("tracer", g.tracer);
    a("setting", g.setting), a("rays", g.rays), a("ray_count", g.ray_count);
    a("growing_rays", g.growing_rays), a("wall_ms", g.wall_ms), a("device_ms", g.device_ms);
    a("judged", g.judged), a("errors", g.errors), a("edges", g.edges);
}

template <class A>
void fields(A& a, AblationRecord& r) {
    a("scene", r.scene), a("work", r.work), a("tracer", r.tracer), a("without", r.without);
    a("setting", r.setting), a("rays", r.rays), a("errors", r.errors), a("edges", r.edges);
    a("wall_ms", r.wall_ms), a("device_ms", r.device_ms), a("ratio", r.ratio);
    a("ratio_low", r.ratio_low), a("ratio_high", r.ratio_high), a("failure", r.failure);
}

template <class A>
void fields(A& a, PixelSheetRecord& s) {
    a("scene", s.scene), a("width", s.width), a("height", s.height), a("pixels", s.pixels);
    a("left_out", s.left_out), a("file", s.file), a("digest", s.digest);
}

template <class A>
void fields(A& a, RefusalRecord& r) {
    a("scene", r.scene), a("tracer", r.tracer), a("reason", r.reason);
}

template <class A>
void fields(A& a, Shard& s) {
    a("index", s.index), a("count", s.count);
}

template <class A>
void fields(A& a, ListRows& l) {
    a("list", l.list), a("rows", l.rows);
}

template <class A>
void fields(A& a, StudyPoint& p) {
    a("key", p.key), a("records", p.records);
}

template <class A>
void fields(A& a, StudyPart& p) {
    a("shard", p.shard), a("manifest", p.manifest);
}

template <class A>
void fields(A& a, StudyRecord& s) {
    a("shard", s.shard), a("keys", s.keys), a("points", s.points), a("parts", s.parts);
}

template <class A>
void fields(A& a, Results& r) {
    a("manifest", r.manifest);
    for_each_list([&](const char* name, auto list) { a(name, r.*list); });
    a("study", r.study);
}

// Enumerations are written as their names.

constexpr ClaimVerdict kClaimVerdicts[] = {ClaimVerdict::holds, ClaimVerdict::fails,
                                           ClaimVerdict::depends, ClaimVerdict::not_measured};
constexpr Expectation kExpectations[] = {Expectation::above, Expectation::below,
                                         Expectation::possible, Expectation::none};

std::string class_name(size_t index) {
    return std::string(to_string(static_cast<HitClass>(index)));
}

/// Makes JSON of values.
class Writer {
  public:
    json value = json::object();

    template <class T>
    void operator()(const char* name, const T& field) {
        value[name] = write(field);
    }

    template <class T>
    static json write(const T& field) {
        if constexpr (std::is_floating_point_v<T>) {
            if (std::isnan(field)) return nullptr;
            if (std::isinf(field)) return field > 0 ? "inf" : "-inf";
            return field;
        } else if constexpr (std::is_enum_v<T>) {
            return to_string(field);
        } else if constexpr (std::is_arithmetic_v<T> || std::is_same_v<T, std::string> ||
                             std::is_same_v<T, ParamValues>) {
            return field;
        } else {
            Writer writer;
            fields(writer, const_cast<T&>(field));  // the list serves both directions
            return std::move(writer.value);
        }
    }

    static json write(const vec3& v) { return {write(v.x), write(v.y), write(v.z)}; }

    template <class T>
    static json write(const std::vector<T>& list) {
        json array = json::array();
        for (const T& element : list) array.push_back(write(element));
        return array;
    }

    template <class T>
    static json write(const std::array<T, kHitClassCount>& by_class) {
        json object = json::object();
        for (size_t c = 0; c < kHitClassCount; ++c) object[class_name(c)] = write(by_class[c]);
        return object;
    }

    template <class T>
    static json write(const std::optional<T>& field) {
        return field ? write(*field) : json(nullptr);
    }
};

/// Fills values from JSON; knows its place for error messages.
class Reader {
  public:
    Reader(const json& object, std::string file, std::string place)
        : object_(object), file_(std::move(file)), place_(std::move(place)) {
        if (!object_.is_object()) refuse_value(place_, object_, "an object");
    }

    template <class T>
    void operator()(const char* name, T& field) {
        known_.insert(name);
        const std::string place = place_.empty() ? name : place_ + "." + name;
        const auto found = object_.find(name);
        if (found == object_.end()) refuse(place, "nothing", "a value");
        read(*found, place, field);
    }

    /// Every field was asked for.
    void finish() const {
        for (const auto& [name, value] : object_.items()) {
            if (!known_.contains(name)) refuse(place_, "unknown field '" + name + "'", "none");
        }
    }

  private:
    [[noreturn]] void refuse(const std::string& place, const std::string& got,
                             const std::string& expected) const {
        throw Error({fmt::format("{}: {}", file_, place.empty() ? "top level" : place), got,
                     expected, "Make the file again with this version of onepass."});
    }
    [[noreturn]] void refuse_value(const std::string& place, const json& got,
                                   const std::string& expected) const {
        refuse(place, std::string(got.type_name()) + " " + got.dump().substr(0, 40), expected);
    }

    template <class T>
    void read(const json& value, const std::string& place, T& field) const {
        if constexpr (std::is_same_v<T, bool>) {
            if (!value.is_boolean()) refuse_value(place, value, "true or false");
            field = value.get<bool>();
        } else if constexpr (std::is_floating_point_v<T>) {
            read_number(value, place, field);
        } else if constexpr (std::is_integral_v<T>) {
            if (!value.is_number_unsigned() ||
                value.get<uint64_t>() > uint64_t{std::numeric_limits<T>::max()}) {
                refuse_value(place, value, fmt::format("a whole number of {} bits", 8 * sizeof(T)));
            }
            field = value.get<T>();
        } else if constexpr (std::is_same_v<T, std::string>) {
            if (!value.is_string()) refuse_value(place, value, "a string");
            field = value.get<std::string>();
        } else {
            Reader reader(value, file_, place);
            fields(reader, field);
            reader.finish();
        }
    }

    template <class T>
    void read_number(const json& value, const std::string& place, T& field) const {
        if (value.is_null()) {
            field = std::numeric_limits<T>::quiet_NaN();
        } else if (value == "inf" || value == "-inf") {
            field = (value == "inf" ? 1 : -1) * std::numeric_limits<T>::infinity();
        } else if (value.is_number()) {
            field = value.get<T>();
        } else {
            refuse_value(place, value, "a number, null, \"inf\" or \"-inf\"");
        }
    }

    void read(const json& value, const std::string& place, HitClass& field) const {
        for (size_t c = 0; c < kHitClassCount; ++c) {
            if (value != class_name(c)) continue;
            field = static_cast<HitClass>(c);
            return;
        }
        refuse_value(place, value, "the name of a class");
    }

    void read(const json& value, const std::string& place, ClaimVerdict& field) const {
        read_name(value, place, field, kClaimVerdicts, "the name of a verdict");
    }
    void read(const json& value, const std::string& place, Expectation& field) const {
        read_name(value, place, field, kExpectations, "the name of an expectation");
    }

    template <class T, size_t N>
    void read_name(const json& value, const std::string& place, T& field, const T (&all)[N],
                   const std::string& expected) const {
        const auto found = std::find_if(std::begin(all), std::end(all),
                                        [&](T one) { return value == to_string(one); });
        if (found == std::end(all)) refuse_value(place, value, expected);
        field = *found;
    }

    void read(const json& value, const std::string& place, vec3& field) const {
        if (!value.is_array() || value.size() != 3) refuse_value(place, value, "three numbers");
        for (int axis = 0; axis < 3; ++axis) read_number(value[axis], place, field[axis]);
    }

    void read(const json& value, const std::string& place, ParamValues& field) const {
        if (!value.is_object()) refuse_value(place, value, "an object of strings");
        for (const auto& [name, text] : value.items()) {
            read(text, place + "." + name, field[name]);
        }
    }

    template <class T>
    void read(const json& value, const std::string& place, std::vector<T>& list) const {
        if (!value.is_array()) refuse_value(place, value, "a list");
        list.resize(value.size());
        for (size_t i = 0; i < list.size(); ++i) {
            read(value[i], fmt::format("{}[{}]", place, i), list[i]);
        }
    }

    template <class T>
    void read(const json& value, const std::string& place,
              std::array<T, kHitClassCount>& by_class) const {
        Reader reader(value, file_, place);
        for (size_t c = 0; c < kHitClassCount; ++c) reader(class_name(c).c_str(), by_class[c]);
        reader.finish();
    }

    template <class T>
    void read(const json& value, const std::string& place, std::optional<T>& field) const {
        if (value.is_null()) return;
        read(value, place, field.emplace());
    }

    const json& object_;
    std::string file_;
    std::string place_;
    std::set<std::string> known_;
};

}  // namespace

std::string_view to_string(Expectation expectation) {
    switch (expectation) {
        case Expectation::above:
            return "above";
        case Expectation::below:
            return "below";
        case Expectation::possible:
            return "possible";
        case Expectation::none:
            break;
    }
    return "none";
}

std::string_view to_string(ClaimVerdict verdict) {
    switch (verdict) {
        case ClaimVerdict::holds:
            return "holds";
        case ClaimVerdict::fails:
            return "fails";
        case ClaimVerdict::depends:
            return "depends";
        case ClaimVerdict::not_measured:
            break;
    }
    return "not measured";
}

uint64_t CheckRecord::errors() const {
    uint64_t sum = 0;
    for (size_t c = 0; c < kHitClassCount; ++c) {
        if (is_error(static_cast<HitClass>(c))) sum += classes[c].count;
    }
    return sum;
}

uint64_t RungRecord::failed() const {
    uint64_t sum = 0;
    for (const FailureCount& failure : failures) sum += failure.count;
    return sum;
}

const RungRecord* breaks_at(const LadderRecord& ladder, const std::string& tracer,
                            const std::string& setting) {
    for (const RungRecord& rung : ladder.rungs) {
        if (rung.tracer == tracer && rung.setting == setting && rung.failed() > 0) return &rung;
    }
    return nullptr;
}

namespace {

constexpr const char* kDigest = "digest";

std::string digest_of(const json& document) {
    nlohmann::json sorted = document;
    sorted.erase(kDigest);
    return sha256_text(sorted.dump(-1, ' ', false, json::error_handler_t::replace));
}

json parsed(const std::string& text, const std::string& file_name) {
    json document = json::parse(text, nullptr, false);
    if (document.is_discarded()) {
        throw Error({file_name, "text that is no JSON", "a result file of onepass",
                     "Name a file written with --json."});
    }
    return document;
}

}  // namespace

std::string to_json(const Results& results) {
    json document = {{"schema_version", Results::kSchemaVersion}};
    document.update(Writer::write(results));
    document[kDigest] = digest_of(document);
    return document.dump(1) + "\n";
}

Seal seal_of(const std::string& text, const std::string& file_name) {
    const json document = parsed(text, file_name);
    if (!document.is_object()) {
        throw Error({file_name, document.type_name(), "an object", "Name a file of onepass."});
    }
    const json stored = document.value(kDigest, json(""));
    return {stored.is_string() ? stored.get<std::string>() : stored.dump(), digest_of(document)};
}

namespace {

/// Version 2 knew no ladders and no reference rows; all else is the same.
void upgrade(json& document) {
    document["schema_version"] = unsigned{Results::kSchemaVersion};
    document["ladders"] = document["tradeoffs"] = json::array();
    for (json& check : document["checks"]) {
        if (check.is_object()) check["reference"] = false;
    }
}

/// What version 3 gained after its first files: those have none of it.
void add_later_fields(json& document) {
    for (const char* list : {"paces", "growth_builds", "growth_traces", "ablations", "pixel_sheets",
                             "refusals", "builds"}) {
        if (!document.contains(list)) document[list] = json::array();
    }
    if (!document.contains("study")) document["study"] = nullptr;
}

/// Fields that its records gained: empty in older files.
void add_later_record_fields(json& document) {
    const auto add = [&](const char* list, const char* field, const json& value) {
        if (!document.contains(list)) return;
        for (json& record : document[list]) {
            if (record.is_object() && !record.contains(field)) record[field] = value;
        }
    };
    add("tracers", "sizing", "");
    for (const char* field : {"again_wall_ms", "again_device_ms"}) {
        add("timings", field, json::array());
    }
    add("timings", "counts", nullptr);
    for (const char* field : {"resolution", "sizes", "chosen"}) add("sweeps", field, "");
    add("sweeps", "ray_count", 0u);
    for (const char* field : {"device_ms", "oracle_wall_ms"}) add("sweeps", field, json::array());
}

}  // namespace

Results results_from_json(const std::string& text, const std::string& file_name) {
    json document = parsed(text, file_name);
    if (document.is_object()) document.erase(kDigest);
    if (document.is_object() && document.value("schema_version", json()) == 2) upgrade(document);
    if (document.is_object()) add_later_fields(document), add_later_record_fields(document);
    Reader reader(document, file_name, "");
    int version = 0;
    reader("schema_version", version);
    if (version != Results::kSchemaVersion) {
        throw Error({file_name + ": schema_version", std::to_string(version),
                     std::to_string(Results::kSchemaVersion),
                     "Make the file again with this version of onepass."});
    }
    Results results;
    fields(reader, results);
    reader.finish();
    return results;
}

void write_results(const Results& results, const fs::path& path) {
    const std::string text = to_json(results);
    if (path == "-") {
        std::cout << text << std::flush;
    } else {
        write_bytes_atomically(path, text);
    }
}

Results read_results(const fs::path& path) {
    std::error_code ignored;
    std::ifstream file(path, std::ios::binary);
    if (!file || fs::is_directory(path, ignored)) {
        throw Error({path.string(), "a file that cannot be opened", "a result file of onepass",
                     "Name a file written with --json."});
    }
    return results_from_json({std::istreambuf_iterator<char>(file), {}}, path.string());
}

}  // namespace onepass
