// Mesh files through Assimp, and every way a scene file can be broken.
#include "core/io/load.h"

#include <algorithm>
#include <cstdlib>

#include <gtest/gtest.h>
#include <zlib.h>

#include "tests/support/errors.h"
#include "tests/support/files.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;
using test::ScratchFolder;

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n";

std::string joined_notes(const LoadedScene& loaded) {
    std::string text;
    for (const std::string& note : loaded.notes) text += note + "\n";
    return text;
}

vec3 corner(const Object& object, uint32_t prim_id, int k) {
    return object.positions[object.triangles[prim_id][k]];
}

std::string gzip(const std::string& text, const std::filesystem::path& path) {
    gzFile file = gzopen(path.c_str(), "wb");
    gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
    gzclose(file);
    return test::read_file(path);
}

// ---- OBJ ----

TEST(Obj, prim_ids_follow_the_file_across_groups_materials_and_objects) {
    // Faces wander between groups and come back; each face's first corner tells its number.
    std::string text;
    constexpr int kFaces = 40;
    for (int i = 0; i < kFaces; ++i) {
        const std::string x = std::to_string(i);
        text += "v " + x + " 0 0\nv " + x + " 1 0\nv " + x + " 0 1\n";
    }
    const char* switches[] = {"g a\n",      "usemtl m\n", "g b\n", "o c\n",
                              "usemtl n\n", "g a\n",      "o c\n"};
    for (int i = 0; i < kFaces; ++i) {
        if (i % 3 == 0) text += switches[static_cast<size_t>(i / 3) % std::size(switches)];
        text += "f " + std::to_string(3 * i + 1) + " " + std::to_string(3 * i + 2) + " " +
                std::to_string(3 * i + 3) + "\n";
    }
    const ScratchFolder folder;
    const LoadedScene loaded = load_scene_file(folder.write("order.obj", text));
    const Object& object = loaded.scene.objects.at(0);
    ASSERT_EQ(object.triangles.size(), static_cast<size_t>(kFaces));
    EXPECT_GT(object.groups.size(), 5u);
    for (uint32_t i = 0; i < kFaces; ++i) {
        EXPECT_EQ(corner(object, i, 0), vec3(static_cast<float>(i), 0, 0));
        EXPECT_EQ(corner(object, i, 1), vec3(static_cast<float>(i), 1, 0));
    }
    EXPECT_TRUE(contains(joined_notes(loaded), "prim_ids of the"));
    EXPECT_EQ(loaded.scene.instances.size(), 1u);
    EXPECT_EQ(loaded.scene.objects.size(), 1u);
}

TEST(Obj, shares_equal_vertices_splits_polygons_and_counts_what_it_leaves_out) {
    const ScratchFolder folder;
    const LoadedScene loaded = load_scene_file(folder.write(
        "mixed.obj", kVertices + "v 1 1 0\nf 1 2 5 3\nf 1 3 4\nl 1 2\np 1\nf 2 2 3\n"));
    const Object& object = loaded.scene.objects[0];
    EXPECT_EQ(object.triangles.size(), 4u);
    EXPECT_EQ(object.positions.size(), 5u);
    EXPECT_TRUE(object.normals.empty());
    const std::string notes = joined_notes(loaded);
    EXPECT_TRUE(contains(notes, "1 polygon split"));
    EXPECT_TRUE(contains(notes, "2 points and lines left out"));
    EXPECT_TRUE(contains(notes, "1 degenerate triangle kept"));
    EXPECT_TRUE(contains(notes, "no camera"));
    EXPECT_TRUE(contains(notes, "no light"));
}

TEST(Obj, reads_normals_and_the_materials_beside_it) {
    const ScratchFolder folder;
    folder.write("look.mtl", "newmtl red\nKd 1 0.25 0\nKs 0.5 0.5 0.5\nNs 20\n");
    const LoadedScene loaded = load_scene_file(folder.write(
        "normals.obj", "mtllib look.mtl\nmtllib gone.mtl\n" + kVertices +
                           "vn 0 0 1\nvn 0 1 0\nusemtl red\nf 1//1 2//2 3//1\nf 2//2 3//2 1//1\n"));
    const Object& object = loaded.scene.objects[0];
    ASSERT_EQ(object.normals.size(), 4u);  // vertex 3 has two normals
    EXPECT_EQ(object.normals[object.triangles[0].y], vec3(0, 1, 0));
    EXPECT_EQ(object.normals[object.triangles[0].z], vec3(0, 0, 1));
    EXPECT_EQ(object.normals[object.triangles[1].y], vec3(0, 1, 0));
    const Material& material = loaded.scene.materials.at(loaded.scene.instances[0].materials[0]);
    EXPECT_EQ(material.name, "red");
    EXPECT_EQ(material.diffuse, vec3(1, 0.25f, 0));
    EXPECT_EQ(material.specular, vec3(0.5f));
    EXPECT_EQ(material.shininess, 20.0f);
    EXPECT_TRUE(contains(joined_notes(loaded), "material library 'gone.mtl' not found"));
    EXPECT_FALSE(contains(joined_notes(loaded), "look.mtl"));
}

TEST(Obj, reads_the_same_from_a_compressed_file) {
    const ScratchFolder folder;
    const std::string text = kVertices + "g a\nf 1 2 3\ng b\nf -1 -2 -3\nf 1 2 \\\n4\n";
    const LoadedScene plain = load_scene_file(folder.write("mesh.obj", text));
    gzip(text, folder.path() / "mesh.obj.gz");
    const LoadedScene compressed = load_scene_file(folder.path() / "mesh.obj.gz");
    EXPECT_EQ(plain.scene, compressed.scene);
    EXPECT_EQ(plain.scene.objects[0].triangles.size(), 3u);
    EXPECT_EQ(plain.scene.name, "mesh");
}

// ---- Other formats ----

TEST(MeshFile, reads_ply_off_and_stl) {
    const ScratchFolder folder;
    const auto ply = folder.write("a.ply",
                                  "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\n"
                                  "property float y\nproperty float z\nelement face 2\n"
                                  "property list uchar int vertex_indices\nend_header\n"
                                  "0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n");
    const auto off =
        folder.write("a.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\n3 0 2 3\n");
    const auto stl = folder.write(
        "a.stl",
        "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
        "endloop\nendfacet\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex 0 1 0\n"
        "vertex 0 0 1\nendloop\nendfacet\nendsolid a\n");
    for (const auto& path : {ply, off, stl}) {
        SCOPED_TRACE(path.extension());
        const Object object = load_scene_file(path).scene.objects.at(0);
        ASSERT_EQ(object.triangles.size(), 2u);
        EXPECT_EQ(object.positions.size(), 4u);
        EXPECT_TRUE(object.normals.empty());
        EXPECT_EQ(corner(object, 0, 1), vec3(1, 0, 0));
        EXPECT_EQ(corner(object, 1, 2), vec3(0, 0, 1));
    }
}

// ---- Broken files ----

struct Broken {
    const char* name;
    std::string content;
    const char* part;  ///< expected in the message
};

TEST(BrokenFile, is_refused_with_one_clear_sentence) {
    const Broken files[] = {
        {"empty.obj", "", "no faces"},
        {"comment.obj", "# nothing\n", "no faces"},
        {"points.obj", kVertices, "no faces"},
        {"high.obj", kVertices + "f 1 2 99\n", "line 5: got vertex index 99, expected at most 4"},
        {"zero.obj", kVertices + "f 0 1 2\n", "line 5: got vertex index '0'"},
        {"low.obj", kVertices + "f -5 1 2\n", "line 5: got vertex index '-5'"},
        {"word.obj", kVertices + "f 1 2 x\n", "line 5: got vertex index 'x'"},
        {"normal.obj", kVertices + "vn 0 0 1\nf 1//1 2//1 3//9\n", "normal index 9"},
        {"no_normals.obj", kVertices + "f 1//-1 2//1 3//1\n", "normal index '-1'"},
        {"nan.obj", "v nan 0 0\n" + kVertices + "f 1 2 3\n", "line 1: got 'nan' in a vertex"},
        {"inf.obj", kVertices + "\n\nv 0 1e999 0\nf 1 2 3\n", "line 7: got '1e999' in a vertex"},
        {"letters.obj", "v a b c\n" + kVertices + "f 1 2 3\n", "line 1: got 'a' in a vertex"},
        {"short.obj", "v 1 2\n" + kVertices + "f 1 2 3\n", "a vertex of 2 numbers"},
        {"utf16.obj", std::string("\xFF\xFEv\0 \0", 6), "16-bit"},
        {"utf16be.obj", std::string("\0v\0 \0\x31", 6), "16-bit"},
        {"lines.obj", kVertices + "f 1 2\n", "line 5: got a face of 2 corners"},
        {"empty.ply", "", "empty.ply"},
        {"points.ply",
         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
         "property float z\nend_header\n0 0 0\n",
         "points.ply"},
        {"range.ply",
         "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
         "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
         "range.ply"},
        {"nan.off", "OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n", "group 0"},
        {"huge.off", "OFF\n353535235358 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
         "353535235358 vertices"},
        {"empty.stl", "", "empty.stl"},
        {"text.glb", "not a glTF file at all, but long enough to look at", "text.glb"},
        {"text.gltf", "{]", "text.gltf"},
        {"hollow.gltf", R"({"asset": {"version": "2.0"}})", "no instances"},
        {"scene.xyz", "1 2 3\n", "extension '.xyz'"},
        {"scene", "1 2 3\n", "no extension"},
        {"plain.obj.gz", kVertices + "f 1 2 3\n", "without a gzip header"},
    };
    const ScratchFolder folder;
    for (const Broken& file : files) {
        SCOPED_TRACE(file.name);
        const auto path = folder.write(file.name, file.content);
        const Error error = error_of([&] { load_scene_file(path); });
        EXPECT_TRUE(contains(error.what(), file.part));
        EXPECT_TRUE(contains(error.parts().where, file.name));
        EXPECT_TRUE(test::is_clear(error));
        EXPECT_EQ(error.kind(), Error::Kind::input);
    }
}

TEST(BrokenFile, missing_files_and_directories_are_refused) {
    const ScratchFolder folder;
    EXPECT_TRUE(contains(error_of([&] { load_scene_file(folder.path() / "none.obj"); }).what(),
                         "no such file"));
    std::filesystem::create_directory(folder.path() / "folder.obj");
    EXPECT_TRUE(contains(error_of([&] { load_scene_file(folder.path() / "folder.obj"); }).what(),
                         "a directory"));
    EXPECT_THROW(load_scene_file(""), Error);
}

TEST(BrokenFile, a_truncated_gzip_file_is_refused) {
    const ScratchFolder folder;
    std::string text = kVertices;
    for (int i = 0; i < 2000; ++i) text += "f 1 2 " + std::to_string(3 + i % 2) + "\n";
    const std::string whole = gzip(text, folder.path() / "mesh.obj.gz");
    for (size_t length : {whole.size() - 1, whole.size() - 8, whole.size() / 2, size_t{12}}) {
        const auto cut = folder.write("cut.obj.gz", whole.substr(0, length));
        const Error error = error_of([&] { load_scene_file(cut); });
        EXPECT_TRUE(contains(error.what(), "truncated")) << length;
    }
}

TEST(Obj, a_forward_reference_is_not_out_of_range) {
    const ScratchFolder folder;
    const auto path = folder.write("forward.obj", "f 1 2 3\n" + kVertices + "f 2 3 4\n");
    EXPECT_EQ(load_scene_file(path).scene.objects[0].triangles.size(), 2u);
}

}  // namespace
}  // namespace onepass
