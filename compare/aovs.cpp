#include "compare/aovs.h"

#include <cstring>

#include <fmt/format.h>

#include "compare/npy.h"
#include "core/error.h"

namespace onepass {
namespace {

/// One plane of a list of structs.
template <class T, class Element, class Get>
Channel plane(std::string name, const std::vector<Element>& elements, Get&& get) {
    std::vector<T> values;
    values.reserve(elements.size());
    for (const Element& element : elements) values.push_back(get(element));
    return {std::move(name), std::move(values)};
}

template <class T, class Element>
Channel member(const std::string& name, const std::vector<Element>& elements, T Element::*pointer) {
    return plane<T>(name, elements, [pointer](const Element& e) { return e.*pointer; });
}

std::vector<Channel> vector_channels(const std::vector<std::string>& names,
                                     const std::vector<vec3>& vectors) {
    std::vector<Channel> channels;
    for (int axis = 0; axis < 3; ++axis) {
        channels.push_back(
            plane<float>(names[axis], vectors, [axis](const vec3& v) { return v[axis]; }));
    }
    return channels;
}

struct Aov {
    std::string name;
    std::vector<Channel> (*channels)(const Frame&);
};

const std::vector<Aov>& all_aovs() {
    static const std::vector<Aov> kAovs = {
        {"color",
         [](const Frame& f) {
             return vector_channels({"R", "G", "B"}, f.color);
         }},
        {"t", [](const Frame& f) { return std::vector{member("t", f.hits, &Hit::t)}; }},
        {"u", [](const Frame& f) { return std::vector{member("u", f.hits, &Hit::u)}; }},
        {"v", [](const Frame& f) { return std::vector{member("v", f.hits, &Hit::v)}; }},
        {"prim_id",
         [](const Frame& f) { return std::vector{member("prim_id", f.hits, &Hit::prim_id)}; }},
        {"inst_id",
         [](const Frame& f) { return std::vector{member("inst_id", f.hits, &Hit::inst_id)}; }},
        {"normal",
         [](const Frame& f) {
             return vector_channels({"N.x", "N.y", "N.z"}, f.normals);
         }},
        {"cells",
         [](const Frame& f) {
             return std::vector{member("cells", f.counters, &RayCounters::cells)};
         }},
        {"tests",
         [](const Frame& f) {
             return std::vector{member("tests", f.counters, &RayCounters::tests)};
         }},
        {"references",
         [](const Frame& f) {
             return std::vector{member("references", f.counters, &RayCounters::references)};
         }},
        {"rays",
         [](const Frame& f) {
             return std::vector{member("rays", f.counters, &RayCounters::rays)};
         }},
        {"flags",
         [](const Frame& f) {
             return std::vector{plane<uint32_t>("flags", f.flags, [](uint32_t x) { return x; })};
         }},
    };
    return kAovs;
}

const Aov& aov_by_name(const std::string& name) {
    std::string known;
    for (const Aov& aov : all_aovs()) {
        if (aov.name == name) return aov;
        known += (known.empty() ? "" : ", ") + aov.name;
    }
    throw Error({"--aov", fmt::format("'{}'", name), "one of " + known, "Choose among them."});
}

size_t length(const Channel& channel) {
    return std::visit([](const auto& values) { return values.size(); }, channel.values);
}

}  // namespace

std::vector<std::string> aov_names() {
    std::vector<std::string> names;
    for (const Aov& aov : all_aovs()) names.push_back(aov.name);
    return names;
}

std::vector<Channel> aov_channels(const Frame& frame, const std::vector<std::string>& names) {
    std::vector<Channel> channels;
    for (const std::string& name : names) {
        for (Channel& channel : aov_by_name(name).channels(frame)) {
            if (length(channel) != frame.color.size()) {
                throw Error({"--aov", fmt::format("'{}', which this strategy does not give", name),
                             "an output of the strategy",
                             "Leave it out or take another strategy."});
            }
            channels.push_back(std::move(channel));
        }
    }
    return channels;
}

std::vector<std::byte> interleaved(const std::vector<Channel>& channels) {
    const size_t stride = 4 * channels.size();
    std::vector<std::byte> bytes(channels.empty() ? 0 : stride * length(channels.front()));
    for (size_t c = 0; c < channels.size(); ++c) {
        std::visit(
            [&](const auto& values) {
                ONEPASS_CHECK_EQ(values.size() * stride, bytes.size());
                for (size_t i = 0; i < values.size(); ++i) {
                    std::memcpy(&bytes[i * stride + 4 * c], &values[i], 4);
                }
            },
            channels[c].values);
    }
    return bytes;
}

void write_channels_npy(const std::filesystem::path& path, uint32_t width, uint32_t height,
                        const std::vector<Channel>& channels) {
    std::vector<NpyField> fields;
    for (const Channel& channel : channels) {
        fields.push_back({channel.name, channel.values.index() == 0 ? "<f4" : "<u4"});
    }
    const size_t shape[] = {height, width};
    write_structured_npy(path, fields, shape, interleaved(channels));
}

}  // namespace onepass
