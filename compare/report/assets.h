// The page's own files, embedded at build time by embed.cmake. Defined in a generated source.
#pragma once

#include <string_view>

namespace onepass::report {

extern const std::string_view kPageHtml;  ///< page.html: the frame, with {{placeholders}}
extern const std::string_view kPageCss;   ///< page.css
extern const std::string_view kPageJs;    ///< page.js
extern const std::string_view kChartJs;   ///< Chart.js 3, minified (MIT licence)

}  // namespace onepass::report
