#include "gpu_glsl/twin/twin_bindings.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"

namespace onepass::twin {
namespace {

[[noreturn]] void missing(const char* what, std::string_view name) {
    throw Error({fmt::format("shader {} '{}'", what, name), "no value for it in the twin",
                 "one from packing, from the frame or from the strategy's parameters",
                 "Give it where the tracer gives it to the GPU."});
}

}  // namespace

void fetch_out_of_range(const TextureData& texture, double x, double y, double z) {
    throw Error(
        {fmt::format("fetch from texture '{}'", texture.name),
         fmt::format("texel ({}, {}, {})", x, y, z),
         fmt::format("a texel within {} x {} x {}", texture.size.x, texture.size.y, texture.size.z),
         "The shader or its packing is wrong: the GPU would read another texel here."});
}

const TextureData& Bindings::texture(const char* name, int dimensions) const {
    const TextureData& found = inputs_.texture(name);
    ONEPASS_CHECK_EQ(found.dimensions, dimensions);
    return found;
}

const gl::ShaderConstant& Bindings::find_constant(std::string_view name) const {
    const auto found = std::find_if(constants_.begin(), constants_.end(),
                                    [&](const gl::ShaderConstant& c) { return c.name == name; });
    if (found == constants_.end()) missing("constant", name);
    return *found;
}

const UniformData& Bindings::find_uniform(std::string_view name) const {
    const auto same_name = [&](const UniformData& u) { return u.name == name; };
    const auto in_inputs =
        std::find_if(inputs_.uniforms.begin(), inputs_.uniforms.end(), same_name);
    if (in_inputs != inputs_.uniforms.end()) return *in_inputs;
    const auto given = std::find_if(uniforms_.begin(), uniforms_.end(), same_name);
    if (given == uniforms_.end()) missing("uniform", name);
    return *given;
}

void Bindings::wrong_type(const char* name) {
    throw Error({fmt::format("shader uniform '{}'", name), "a value of another type",
                 "the type that the shader declares",
                 "Give it where the tracer gives it to the GPU, with that type."});
}

}  // namespace onepass::twin
