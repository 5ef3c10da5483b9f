// A first look at OBJ text, for the defects that Assimp hides: it reads "abc" as 0, drops normals
// whose index is out of range, and gives no line numbers. Internal to core/io.
#pragma once

#include <string_view>

namespace onepass {

/// Throws: Error naming the line, for text that is not 8-bit, a vertex without three finite
/// numbers, or a face whose index is 0 or out of range; for a file without faces.
/// Cost: one pass over the text.
void check_obj_text(std::string_view text);

}  // namespace onepass
