// Declared parameters: defaults, types, and errors that name what is allowed.
#include "core/params.h"

#include <gtest/gtest.h>

#include "tests/support/errors.h"

namespace onepass {
namespace {

using test::contains;
using test::error_of;

std::vector<ParamInfo> infos() {
    return {
        {"edge", ParamInfo::Type::real, "1.004", "edge tolerance, a factor", {}},
        {"depth", ParamInfo::Type::integer, "4", "bounces", {}},
        {"mode", ParamInfo::Type::choice, "half", "address width", {"half", "float"}},
        {"label", ParamInfo::Type::text, "", "any text", {}},
    };
}

TEST(Params, fills_in_defaults_and_keeps_what_is_given) {
    const Params params("paper", infos(), {{"depth", "-2"}, {"mode", "float"}});
    EXPECT_EQ(params.real("edge"), 1.004);
    EXPECT_EQ(params.integer("depth"), -2);
    EXPECT_EQ(params.text("mode"), "float");
    EXPECT_EQ(params.text("label"), "");
    EXPECT_EQ(params.values().size(), 4u);
    EXPECT_EQ(params.values().at("edge"), "1.004");
}

TEST(Params, refuses_an_unknown_name_and_lists_the_known_ones) {
    const Error error = error_of([] { Params("paper", infos(), {{"egde", "1"}}); });
    EXPECT_TRUE(contains(error.parts().where, "paper"));
    EXPECT_TRUE(contains(error.parts().got, "egde"));
    EXPECT_TRUE(contains(error.parts().expected, "edge, depth, mode, label"));
}

TEST(Params, refuses_values_of_another_type) {
    const std::pair<const char*, const char*> wrong[] = {
        {"edge", "much"},
        {"edge", ""},
        {"edge", "1.0x"},
        {"edge", "nan"},
        {"edge", "inf"},
        {"depth", "1.5"},
        {"depth", "99999999999999999999"},
        {"depth", " 1"},
        {"mode", "double"},
    };
    for (const auto& [name, value] : wrong) {
        const ParamValues values{{name, value}};
        const Error error = error_of([&] { Params("paper", infos(), values); });
        EXPECT_TRUE(contains(error.parts().where, name)) << value;
        EXPECT_TRUE(contains(error.parts().got, value));
        EXPECT_TRUE(test::is_clear(error));
    }
}

}  // namespace
}  // namespace onepass
