// Catching Error and looking at its parts.
#pragma once

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "core/error.h"

namespace onepass::test {

/// What the call throws; a test failure, and empty parts, if it throws no Error.
template <class Call>
Error error_of(Call&& call) {
    try {
        call();
    } catch (const Error& e) {
        return e;
    }
    ADD_FAILURE() << "no Error was thrown";
    return Error({});
}

inline testing::AssertionResult contains(const std::string& text, const std::string& part) {
    if (text.find(part) != text.npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "\"" << text << "\" does not contain \"" << part << "\"";
}

/// An error a user can act on: one line, all four parts said.
inline testing::AssertionResult is_clear(const Error& error) {
    const Error::Parts& p = error.parts();
    const std::string text = error.what();
    if (p.where.empty() || p.got.empty() || p.expected.empty() || p.remedy.empty()) {
        return testing::AssertionFailure() << "a part is missing: " << text;
    }
    if (std::count(text.begin(), text.end(), '\n') > 0) {
        return testing::AssertionFailure() << "more than one line: " << text;
    }
    return testing::AssertionSuccess();
}

}  // namespace onepass::test
