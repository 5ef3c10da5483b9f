// Tracers by name, by prefix and by pattern.
#include "core/catalogue.h"

#include <gtest/gtest.h>

#include "tests/support/errors.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;

Catalogue sample() {
    Catalogue catalogue;
    for (const char* name :
         {"paper/texture2d/fragment", "paper/texture2d/compute", "paper/texture2d/twin32",
          "paperlike/buffer/compute", "embree/fast/1"}) {
        CatalogueEntry entry;
        entry.info.name = name;
        catalogue.add(std::move(entry));
    }
    return catalogue;
}

std::vector<std::string> names(const Catalogue& catalogue, const std::string& pattern) {
    std::vector<std::string> result;
    for (const CatalogueEntry* entry : catalogue.select(pattern)) {
        result.push_back(entry->info.name);
    }
    return result;
}

using Names = std::vector<std::string>;

TEST(Catalogue, selects_by_full_name_and_first_by_prefix) {
    const Catalogue catalogue = sample();
    EXPECT_EQ(names(catalogue, "paper/texture2d/compute"), Names{"paper/texture2d/compute"});
    EXPECT_EQ(names(catalogue, "paper/texture2d"), Names{"paper/texture2d/fragment"});
    EXPECT_EQ(names(catalogue, "paper"), Names{"paper/texture2d/fragment"});
    EXPECT_EQ(names(catalogue, "paperlike"), Names{"paperlike/buffer/compute"});
}

TEST(Catalogue, selects_every_match_of_a_pattern_in_order) {
    const Catalogue catalogue = sample();
    EXPECT_EQ(names(catalogue, "*").size(), 5u);
    EXPECT_EQ(names(catalogue, "*/compute"),
              (Names{"paper/texture2d/compute", "paperlike/buffer/compute"}));
    EXPECT_EQ(names(catalogue, "paper/*/twin*"), Names{"paper/texture2d/twin32"});
    EXPECT_EQ(names(catalogue, "e*b*r*1"), Names{"embree/fast/1"});
}

TEST(Catalogue, refuses_unknown_names_and_lists_the_known_ones) {
    const Catalogue catalogue = sample();
    for (const char* unknown : {"pape", "paper/", "*/geometry", "", "embree/fast/1/x"}) {
        const Error error = error_of([&] { catalogue.select(unknown); });
        EXPECT_TRUE(contains(error.parts().expected, "embree/fast/1")) << unknown;
    }
    EXPECT_THROW(catalogue.at("paper"), Error);
    EXPECT_EQ(catalogue.at("embree/fast/1").info.name, "embree/fast/1");
}

TEST(Catalogue, refuses_a_second_tracer_of_the_same_name) {
    Catalogue catalogue = sample();
    CatalogueEntry entry;
    entry.info.name = "embree/fast/1";
    EXPECT_THROW(catalogue.add(entry), Error);
}

}  // namespace
}  // namespace onepass
