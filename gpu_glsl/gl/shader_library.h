// The shader files: composed into one text a stage, and read for the strategies they register.
//
// C++ adds nothing to a shader but `#version` and one block of typed constants. Needs no GL.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "core/catalogue.h"
#include "core/params.h"

namespace onepass::gl {

/// A typed constant of a variant: `const int light_count = 2;`.
struct ShaderConstant {
    std::string name;
    std::variant<bool, int32_t, uint32_t, float> value;
    bool late = false;  ///< `uniform int light_count;`: the program is given the value

    bool operator==(const ShaderConstant&) const = default;
};

/// The constant as GLSL declares it. A float is written so that reading it gives the same bits.
std::string to_glsl(const ShaderConstant& constant);

/// One stage of a program: which files, for which GLSL, with which constants.
struct ShaderVariant {
    int glsl_version = 330;
    std::string stage;                    ///< "vertex", "fragment" or "compute"
    std::vector<std::string> files = {};  ///< relative to the shader root; in this order
    std::vector<ShaderConstant> constants = {};
};

/// A stage's text as the driver gets it.
struct ComposedShader {
    /// Where a line of `text` comes from.
    struct Line {
        uint32_t file = 0;  ///< index into `files`
        uint32_t line = 0;  ///< from 1
    };
    std::string stage;
    std::string text;
    std::vector<Line> lines;         ///< of line k of `text`: lines[k - 1]
    std::vector<std::string> files;  ///< [0] stands for what C++ wrote
    std::string hash;                ///< of `text`: FNV-1a, 64 bits, 16 hexadecimal digits
};

/// What the front matter of strategies/NAME.glsl says.
struct StrategyInfo {
    std::string name;
    std::string file;  ///< strategies/NAME.glsl
    std::string summary;
    std::string source;                 ///< paper, section, figure
    std::string structure;              ///< folder of storage/
    std::vector<std::string> storages;  ///< each has its file storage/STRUCTURE/NAME.glsl
    std::vector<std::string> entries;   ///< "fragment", "compute"
    int gl = 330;                       ///< least OpenGL version as a number: 330 for 3.3
    bool twin = true;
    std::string no_twin_reason;  ///< if `twin` is false
    bool by_default = true;      ///< TracerInfo::by_default
    std::vector<ParamInfo> params;
    std::vector<Deviation> deviations;  ///< in the order of their lines
};

/// Shader files by path relative to the shader root ("lib/dda.glsl").
class ShaderLibrary {
  public:
    explicit ShaderLibrary(std::map<std::string, std::string> files) : files_(std::move(files)) {}

    /// The files of gpu_glsl/shaders as they were when this binary was built; if the environment
    /// variable ONEPASS_SHADER_DIR is set, the files of that folder as they are now.
    static ShaderLibrary embedded();

    /// Throws: Error if `root` is not a readable folder.
    static ShaderLibrary from_directory(const std::filesystem::path& root);

    const std::map<std::string, std::string>& files() const { return files_; }

    /// Joins `#version`, `#extension` lines, the constants and the files, following `#include
    /// "path"` (relative to the shader root, each file once). Of `#if NEEDS(name)`, `#else`,
    /// `#endif` it keeps the side that the constant `name` says, and not the other one's includes.
    ///
    /// Places are kept beside the text, not in it as `#line`: Mesa forgets a `#line`'s
    /// source-string number in all but syntax errors, and so a driver's line is the line that
    /// `onepass shader` prints. Throws: Error with file:line for an #include of a file that does
    /// not exist, a NEEDS of what is no constant of type bool, or one without its #endif.
    ComposedShader compose(const ShaderVariant& variant) const;

    /// Every strategies/NAME.glsl, sorted by name.
    /// Throws: Error with file:line if front matter is missing, unknown, ill-formed or names a
    /// storage without a file.
    std::vector<StrategyInfo> strategies() const;

  private:
    std::map<std::string, std::string> files_;
};

/// The driver's log with `file:line: ` instead of places in the composed text (Mesa's, NVIDIA's and
/// AMD's forms); other lines stay as they are.
std::string map_errors(const ComposedShader& shader, const std::string& driver_log);

/// The file:line of the first error in a driver's log; empty if there is none.
std::string first_error_place(const ComposedShader& shader, const std::string& driver_log);

/// FNV-1a, 64 bits, as 16 hexadecimal digits.
std::string fnv1a_hex(std::string_view text);

/// The files that cmake/EmbedShaders.cmake wrote into this binary.
std::map<std::string, std::string> embedded_shader_files();

}  // namespace onepass::gl
