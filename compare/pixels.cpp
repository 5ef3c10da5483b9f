#include "compare/pixels.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace onepass {
namespace {

using json = nlohmann::ordered_json;

/// How much a pixel wants to be seen.
enum class Interest : uint8_t { none, edge_or_tie, error };

Interest interest_of(HitClass hit_class) {
    if (is_error(hit_class)) return Interest::error;
    return hit_class == HitClass::agree ? Interest::none : Interest::edge_or_tie;
}

std::vector<Interest> interests(std::span<const RayClasses> classes,
                                std::span<const uint32_t> pixel_of_ray, size_t pixel_count) {
    std::vector<Interest> by_pixel(pixel_count, Interest::none);
    for (const RayClasses& of_tracer : classes) {
        ONEPASS_CHECK_EQ(of_tracer.size(), pixel_of_ray.size());
        for (size_t ray = 0; ray < of_tracer.size(); ++ray) {
            if (!of_tracer[ray]) continue;
            Interest& interest = by_pixel[pixel_of_ray[ray]];
            interest = std::max(interest, interest_of(*of_tracer[ray]));
        }
    }
    return by_pixel;
}

/// At most `room` of the candidates, evenly spread.
std::vector<uint32_t> thinned(const std::vector<uint32_t>& candidates, size_t room) {
    if (candidates.size() <= room) return candidates;
    std::vector<uint32_t> kept;
    for (size_t k = 0; k < room; ++k) kept.push_back(candidates[k * candidates.size() / room]);
    return kept;
}

/// The shortest decimals that are this float: as a double it would have twice as many.
json short_number(float value) {
    if (!std::isfinite(value)) return nullptr;
    return std::stod(fmt::format("{}", value));
}

json id_number(uint32_t id) { return id == kNoId ? json(-1) : json(id); }

/// The distinct lists of a sheet.
class Columns {
  public:
    size_t add(json column) {
        const auto known = std::find(columns_.begin(), columns_.end(), column);
        if (known != columns_.end()) return static_cast<size_t>(known - columns_.begin());
        columns_.push_back(std::move(column));
        return columns_.size() - 1;
    }

    template <class T, class Number>
    size_t add_each(const std::vector<T>& values, Number&& number) {
        json column = json::array();
        for (const T& value : values) column.push_back(number(value));
        return add(std::move(column));
    }

    const std::vector<json>& all() const { return columns_; }

  private:
    std::vector<json> columns_;
};

json tracer_json(const SheetColumn& tracer, Columns& columns) {
    const auto of_hits = [&](auto&& number) { return columns.add_each(tracer.hits, number); };
    json entry = {{"name", tracer.tracer}};
    entry["t"] = of_hits([](const Hit& h) { return short_number(h.t); });
    entry["prim"] = of_hits([](const Hit& h) { return id_number(h.prim_id); });
    entry["inst"] = of_hits([](const Hit& h) { return id_number(h.inst_id); });
    entry["class"] = columns.add_each(tracer.classes, [](const std::optional<HitClass>& c) {
        return c ? json(static_cast<unsigned>(*c)) : json(-1);
    });
    if (!tracer.colors.empty()) {
        entry["color"] = columns.add_each(tracer.colors, [](const std::array<uint8_t, 3>& c) {
            return json(c[0] << 16 | c[1] << 8 | c[2]);
        });
    }
    if (!tracer.counters.empty()) {
        const auto of_counters = [&](auto&& number) {
            return columns.add_each(tracer.counters, number);
        };
        entry["cells"] = of_counters([](const RayCounters& c) { return json(c.cells); });
        entry["tests"] = of_counters([](const RayCounters& c) { return json(c.tests); });
        entry["rays"] = of_counters([](const RayCounters& c) { return json(c.rays); });
    }
    return entry;
}

}  // namespace

SheetPixels choose_pixels(std::span<const RayClasses> classes,
                          std::span<const uint32_t> pixel_of_ray, uint32_t width, uint32_t height) {
    const std::vector<Interest> by_pixel = interests(classes, pixel_of_ray, size_t{width} * height);

    // The lattice, half a step from the border.
    const uint32_t step =
        std::max(1u, (std::max(width, height) + kSheetLattice - 1) / kSheetLattice);
    SheetPixels chosen;
    std::vector<uint32_t> errors, others;
    for (uint32_t y = 0; y < height; ++y) {
        for (uint32_t x = 0; x < width; ++x) {
            const uint32_t pixel = x + width * y;
            if (x % step == step / 2 && y % step == step / 2) {
                chosen.pixels.push_back(pixel);
            } else if (by_pixel[pixel] == Interest::error) {
                errors.push_back(pixel);
            } else if (by_pixel[pixel] == Interest::edge_or_tie) {
                others.push_back(pixel);
            }
        }
    }

    // The odd pixels, as far as there is room.
    for (const std::vector<uint32_t>* candidates : {&errors, &others}) {
        const size_t room = kMostSheetPixels - std::min(kMostSheetPixels, chosen.pixels.size());
        const std::vector<uint32_t> kept = thinned(*candidates, room);
        chosen.pixels.insert(chosen.pixels.end(), kept.begin(), kept.end());
        chosen.left_out += candidates->size() - kept.size();
    }
    std::sort(chosen.pixels.begin(), chosen.pixels.end());
    return chosen;
}

std::string to_json(const PixelSheet& sheet) {
    Columns columns;
    json tracers = json::array();
    for (const SheetColumn& tracer : sheet.tracers) {
        ONEPASS_CHECK_EQ(tracer.hits.size(), sheet.pixels.size());
        ONEPASS_CHECK_EQ(tracer.classes.size(), sheet.pixels.size());
        tracers.push_back(tracer_json(tracer, columns));
    }
    json classes = json::array();
    for (size_t c = 0; c < kHitClassCount; ++c) {
        classes.push_back(to_string(static_cast<HitClass>(c)));
    }
    const json document = {{"scene", sheet.scene},    {"width", sheet.width},
                           {"height", sheet.height},  {"classes", classes},
                           {"pixels", sheet.pixels},  {"tracers", tracers},
                           {"columns", columns.all()}};
    return document.dump(-1, ' ', false, json::error_handler_t::replace) + "\n";
}

}  // namespace onepass
