# The report's page files and Chart.js, embedded into onepass_compare.
find_file(ONEPASS_CHART_JS chart.min.js PATHS /usr/share/javascript/chart.js REQUIRED
          DOC "Chart.js 3 (Debian: libjs-chart.js)")

set(report_dir ${CMAKE_CURRENT_LIST_DIR})
set(report_assets ${CMAKE_CURRENT_BINARY_DIR}/report_assets.cpp)
set(report_inputs ${report_dir}/page.html ${report_dir}/page.css ${report_dir}/page.js
    ${ONEPASS_CHART_JS})
add_custom_command(
    OUTPUT ${report_assets}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${report_assets}
            "-DNAMES=kPageHtml;kPageCss;kPageJs;kChartJs" "-DINPUTS=${report_inputs}"
            -P ${report_dir}/embed.cmake
    DEPENDS ${report_inputs} ${report_dir}/embed.cmake
    COMMENT "Embedding the report page" VERBATIM)
target_sources(onepass_compare PRIVATE ${report_assets})
