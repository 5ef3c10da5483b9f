// The sizing file: what is written is read back, and what does not fit is refused with its reason.
#include "compare/sizing_file.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "compare/tuning.h"
#include "core/error.h"
#include "tests/support/temporary_folder.h"

namespace onepass {
namespace {

Scene two_objects() {
    Scene scene;
    scene.objects.resize(2);
    scene.objects[0].name = "dense";
    scene.objects[0].triangles.resize(100);
    scene.objects[1].name = "coarse";
    scene.objects[1].triangles.resize(2);
    return scene;
}

SweepPoint measured_point() {
    SweepPoint point;
    point.scene = "two";
    point.rays = "primary";
    point.tracer = "grid/buffer/compute";
    point.top_density = 2.5;
    point.object_density = 0.1;
    point.chosen = kPerObjectSize;
    point.bytes = 4096;
    point.errors = 3;
    return point;
}

SizingFile file_with(const SweepPoint& point) {
    return {{{"two", "00ff", {tracer_sizing(point, two_objects(), 12.5, NAN)}}}};
}

GridSize looked_up(const SizingFile& file, const std::string& tracer = "grid/buffer/compute",
                   const std::string& hash = "00ff") {
    return size_from(file, "sizes.json", tracer, two_objects(), hash, {"primary"});
}

/// The message of what `act` throws.
std::string refusal_of(const std::function<void()>& act) {
    try {
        act();
    } catch (const Error& error) {
        return error.what();
    }
    return "no Error";
}

void expect_says(const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(SizingFile, reads_back_what_was_written) {
    const TemporaryFolder folder;
    SweepPoint point = measured_point();
    point.sizes = "16,8x4x2";
    const SizingFile file = file_with(point);
    write_sizing_file(file, folder.path() / "sizes.json");
    const SizingFile again = read_sizing_file(folder.path() / "sizes.json");
    EXPECT_EQ(to_json(again), to_json(file));
    const TracerSizing& sizing = again.scenes[0].tracers[0];
    EXPECT_EQ(sizing.objects[0], (ObjectSize{"dense", 100, "16"}));
    EXPECT_EQ(sizing.objects[1], (ObjectSize{"coarse", 2, "8x4x2"}));
    EXPECT_EQ(sizing.measured_ns, 12.5);
    EXPECT_TRUE(std::isnan(sizing.predicted_ns));
    EXPECT_EQ(sizing.chosen, kPerObjectSize);
    EXPECT_EQ(sizing.bytes, 4096u);
    EXPECT_EQ(sizing.errors, 3u);
}

TEST(SizingFile, gives_the_size_that_the_point_had) {
    SweepPoint point = measured_point();
    EXPECT_EQ(looked_up(file_with(point)), (GridSize{2.5, 0.1, "", "", kFileSize}))
        << "one density for all";
    point.sizes = "16,8x4x2";
    EXPECT_EQ(looked_up(file_with(point)).sizes, "16,8x4x2");
    point.sizes.clear();
    point.resolution = "8x4x2";
    EXPECT_EQ(looked_up(file_with(point)).resolution, "8x4x2");
}

TEST(SizingFile, serves_other_entries_of_the_same_storage_and_prefers_its_own) {
    SizingFile file = file_with(measured_point());
    EXPECT_EQ(looked_up(file, "grid/buffer/twin32").object_density, 0.1);
    TracerSizing twin = file.scenes[0].tracers[0];
    twin.tracer = "grid/buffer/twin32";
    twin.objects[0].size = twin.objects[1].size = "7";
    file.scenes[0].tracers.push_back(twin);
    EXPECT_EQ(looked_up(file, "grid/buffer/twin32").object_density, 7.0);
    TracerSizing random = file.scenes[0].tracers[0];
    random.rays = "random";
    file.scenes[0].tracers.insert(file.scenes[0].tracers.begin(), random);
    file.scenes[0].tracers[0].top_density = 99.0;
    EXPECT_EQ(looked_up(file).top_density, 2.5) << "the ray kind that is asked for";
}

TEST(SizingFile, names_what_does_not_fit) {
    const SizingFile file = file_with(measured_point());
    expect_says(refusal_of([&] { looked_up(file, "grid/buffer/compute", "1234"); }), "hash 1234");
    expect_says(refusal_of([&] { looked_up(file, "paper/texture2d/fragment"); }),
                "sizes for grid/buffer/compute");
    SizingFile short_of_one = file;
    short_of_one.scenes[0].tracers[0].objects.pop_back();
    expect_says(refusal_of([&] { looked_up(short_of_one); }), "'coarse' of 2 triangles");
    SizingFile mixed_up = file;
    std::swap(mixed_up.scenes[0].tracers[0].objects[0], mixed_up.scenes[0].tracers[0].objects[1]);
    expect_says(refusal_of([&] { looked_up(mixed_up); }), "object 0");
}

TEST(SizingFile, refuses_text_that_is_no_sizing_file_with_its_place) {
    const auto document = nlohmann::json::parse(to_json(file_with(measured_point())));
    const auto refusal = [](const std::string& text) {
        return refusal_of([&] { sizing_from_json(text, "sizes.json"); });
    };
    EXPECT_EQ(refusal(document.dump()), "no Error");
    expect_says(refusal("{"), "no JSON");
    expect_says(refusal("[]"), "sizes.json");
    expect_says(refusal("{}"), "onepass_sizing");

    auto wrong = document;
    wrong["onepass_sizing"] = 99;
    expect_says(refusal(wrong.dump()), "99");
    wrong = document;
    wrong["scenes"][0]["tracers"][0].erase("top_density");
    expect_says(refusal(wrong.dump()), "scenes[0]: tracers[0]: top_density");
    wrong = document;
    wrong["scenes"][0]["tracers"][0]["objects"][1]["size"] = "-4";
    expect_says(refusal(wrong.dump()), "'-4'");
    wrong = document;
    wrong["scenes"][0]["tracers"][0]["objects"][1]["size"] = 4;
    expect_says(refusal(wrong.dump()), "a text");
    wrong = document;
    wrong["scenes"][0]["more"] = 1;
    expect_says(refusal(wrong.dump()), "unknown field 'more'");
    expect_says(refusal_of([] { read_sizing_file("/does/not/exist.json"); }), "exist.json");
}

}  // namespace
}  // namespace onepass
