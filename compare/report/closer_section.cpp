// A closer look at one scene's pictures: two of them under a divider, and every tracer's answer at
// a pixel. page.js brings it to life; without JavaScript it stays hidden, and the pictures above
// hold the same.
#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compare/hash.h"
#include "compare/report/html.h"
#include "compare/report/sections.h"
#include "core/error.h"

namespace onepass::report {
namespace {

using nlohmann::json;

/// The first sheet of the scene: of several runs, their pictures are told apart by name only.
const PixelSheetRecord* sheet_of(const Results& run, const std::string& scene) {
    for (const PixelSheetRecord& sheet : run.pixel_sheets) {
        if (sheet.scene == scene) return &sheet;
    }
    return nullptr;
}

json read_sheet(const std::filesystem::path& path, const PixelSheetRecord& record) {
    const std::string remedy =
        "Keep the file beside the JSON file that names it, or make the run again";
    std::ifstream file(path, std::ios::binary);
    if (!file) throw Error({path.string(), "no readable file", "a sheet of pixels", remedy});
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::string digest = sha256_text(text);
    if (digest != record.digest) {
        throw Error({path.string(), "a file of SHA-256 " + digest, record.digest, remedy});
    }
    return json::parse(text);
}

std::string picker(const std::string& side, const std::string& text) {
    return fmt::format("<label>{1} <select data-side=\"{0}\"></select></label>", side, text);
}

}  // namespace

std::string closer_block(const SceneDossier& scene, size_t index, const std::string& layers) {
    return fmt::format(
        "<div class=\"closer\" data-closer=\"{0}\" hidden>\n{4}<h3>Look closer</h3>\n"
        "<div class=\"pickers\">{2}{3}</div>\n"
        "<div class=\"bench\"><div>\n"
        "<div class=\"stage\" tabindex=\"0\" role=\"application\" aria-label=\"Picture of {1} "
        "under "
        "a divider. Arrow keys walk from pixel to pixel.\">"
        "<img class=\"under\" alt=\"\"><img class=\"over\" alt=\"\"><span class=\"divider\"></span>"
        "<span class=\"cursor\" hidden></span></div>\n"
        "<label class=\"slide\">Divider <input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
        "step=\"1\"></label>\n</div>\n"
        "<div class=\"reading\" hidden>\n<div class=\"walk\">"
        "<button type=\"button\" data-walk=\"-1\">Previous odd pixel</button>"
        "<button type=\"button\" data-walk=\"1\">Next odd pixel</button></div>\n"
        "<p class=\"where\" aria-live=\"polite\"></p>\n"
        "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Answers at the pixel, "
        "{1}\"><table class=\"classes\"><thead><tr><th scope=\"col\" class=\"text\">Tracer</th>"
        "<th scope=\"col\" class=\"text\">Class</th><th scope=\"col\">t</th>"
        "<th scope=\"col\">prim_id</th><th scope=\"col\">inst_id</th><th scope=\"col\">cells</th>"
        "<th scope=\"col\">tests</th><th scope=\"col\" class=\"text\">Colour</th></tr></thead>"
        "<tbody></tbody></table></div>\n"
        "<p><code class=\"copy explain\"></code></p>\n"
        "<p class=\"note left-out\"></p>\n"
        "<p class=\"note\"><em>Odd</em>: some tracer’s class there is not <code>agree</code>. "
        "t, ids and class are of the primary ray; cells and tests of all rays of the pixel. Click "
        "a "
        "pixel, or walk with the arrow keys: the nearest one that is kept is taken.</p>\n"
        "</div></div></div>\n",
        index, escape(scene.name), picker("left", "Left of the divider"),
        picker("right", "Right of it"), layers);
}

std::string closer_data(const Dossier& dossier) {
    json all = json::array();
    for (const SceneDossier& scene : dossier.scenes) {
        json entry = {{"scene", scene.name}, {"sheet", nullptr}};
        for (size_t r = 0; r < dossier.runs->size() && entry["sheet"].is_null(); ++r) {
            const PixelSheetRecord* sheet = sheet_of((*dossier.runs)[r], scene.name);
            if (!sheet) continue;
            entry["sheet"] = read_sheet((*dossier.folders)[r] / sheet->file, *sheet);
            entry["left_out"] = sheet->left_out;
        }
        all.push_back(entry);
    }
    return all.dump(-1, ' ', false, json::error_handler_t::replace);
}

}  // namespace onepass::report
