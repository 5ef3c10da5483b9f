// Does a result file say what its own samples and counts say?
//
// Every headline number (median, rate, ratio, interval, verdict, error count) is derived again by
// the functions that made it, and held against the stored one; the digest tells of every other edit
// (results.h, seal_of). Reads one file's text and the files it names; knows no page.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace onepass {

/// A stored figure that does not follow from the file's samples and counts.
struct Discrepancy {
    std::string place;  ///< "timings[3].median_ms"
    std::string stored;
    std::string derived;
};

struct Audit {
    std::vector<Discrepancy> discrepancies;
    uint64_t derived = 0;    ///< figures derived again, whatever came out
    uint64_t underived = 0;  ///< stored figures whose samples the file does not hold
    bool sealed = false;     ///< the file holds a digest
    bool intact = false;     ///< and it is that of the content

    bool passed() const { return discrepancies.empty() && (intact || !sealed); }
};

/// How far a stored figure may be from the derived one, as a share: the arithmetic is the same, but
/// logarithms of other C libraries differ in the last digits. Any sample matters more than this.
inline constexpr double kSameFigure = 1e-12;

/// `folder`: where the files lie that the results name. Throws: Error as results_from_json.
Audit audit(const std::string& text, const std::string& file_name,
            const std::filesystem::path& folder);

}  // namespace onepass
