#include "compare/audit.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numeric>
#include <span>

#include <fmt/format.h>

#include "compare/ablation.h"
#include "compare/claims.h"
#include "compare/frame_timing.h"
#include "compare/hash.h"
#include "compare/results.h"
#include "compare/statistics.h"
#include "compare/timing.h"

namespace onepass {
namespace {

bool same(double stored, double derived) {
    if (std::isnan(stored) || std::isnan(derived)) return std::isnan(stored) == std::isnan(derived);
    if (stored == derived) return true;  // infinities
    return std::abs(stored - derived) <= kSameFigure * std::abs(derived);
}

/// Goes through the records list by list.
class Auditor {
  public:
    Auditor(const Results& results, const std::filesystem::path& folder, Audit& audit)
        : results_(results), folder_(folder), audit_(audit) {}

    void run() {
        each("checks", results_.checks, [&](const CheckRecord& r) { check(r); });
        each("images", results_.images, [&](const ImageRecord& r) { image(r); });
        each("timings", results_.timings, [&](const TimingRecord& r) { timing(r); });
        each("frame_timings", results_.frame_timings, [&](const FrameTimingRecord& r) {
            const bool alone = r.oracle_wall_ms.empty();
            if (!alone && !paired("wall_ms", r.wall_ms.size(), r.oracle_wall_ms.size())) return;
            FrameTimingRecord again = r;
            summarise(again, seed());
            expect("median_ms", r.median_ms, again.median_ms);
            expect("frames_per_s", r.frames_per_s, again.frames_per_s);
            ratio(r, {again.ratio, again.ratio_low, again.ratio_high});
        });
        each("claims", results_.claims, [&](const ClaimRecord& r) { claim(r); });
        each("sweeps", results_.sweeps, [&](const SweepPoint& r) {
            if (r.failure.empty()) sweep(r);
        });
        each("tradeoffs", results_.tradeoffs, [&](const TradeoffPoint& r) {
            if (!paired("wall_ms", r.wall_ms.size(), r.oracle_wall_ms.size())) return;
            ratio(r, ratio_of_medians(r.oracle_wall_ms, r.wall_ms, seed()));
        });
        ablations();
        each("pixel_sheets", results_.pixel_sheets, [&](const PixelSheetRecord& r) { sheet(r); });
    }

  private:
    uint64_t seed() const { return results_.manifest.seed; }

    template <class Record, class Look>
    void each(const char* list, const std::vector<Record>& records, Look&& look) {
        for (size_t i = 0; i < records.size(); ++i) {
            place_ = fmt::format("{}[{}]", list, i);
            look(records[i]);
        }
    }

    // ---- One figure.

    void differs(const std::string& field, const std::string& stored, const std::string& derived) {
        audit_.discrepancies.push_back({place_ + "." + field, stored, derived});
    }

    void expect(const std::string& field, double stored, double derived) {
        ++audit_.derived;
        if (!same(stored, derived)) {
            differs(field, fmt::format("{}", stored), fmt::format("{}", derived));
        }
    }

    void expect_count(const std::string& field, uint64_t stored, uint64_t derived) {
        ++audit_.derived;
        if (stored != derived) differs(field, std::to_string(stored), std::to_string(derived));
    }

    void expect_text(const std::string& field, const std::string& stored,
                     const std::string& derived) {
        ++audit_.derived;
        if (stored != derived) differs(field, "'" + stored + "'", "'" + derived + "'");
    }

    void expect_verdict(const std::string& field, bool stored, bool derived) {
        const auto word = [](bool passed) { return passed ? "true" : "false"; };
        expect_text(field, word(stored), word(derived));
    }

    /// Ratios are of samples paired round by round; without as many on both sides there is none.
    bool paired(const std::string& fields, size_t a, size_t b) {
        expect_count("samples of " + fields, a, b);
        return a == b;
    }

    template <class Record>
    void ratio(const Record& record, const RatioInterval& derived) {
        expect("ratio", record.ratio, derived.ratio);
        expect("ratio_low", record.ratio_low, derived.low);
        expect("ratio_high", record.ratio_high, derived.high);
    }

    // ---- The records.

    void check(const CheckRecord& r) {
        uint64_t classed = 0;
        bool within = true;
        for (size_t c = 0; c < kHitClassCount; ++c) {
            classed += r.classes[c].count;
            within &= r.classes[c].count <= r.allowed[c];
            const std::string name(to_string(static_cast<HitClass>(c)));
            expect_verdict("classes." + name + ".worst is there", r.classes[c].worst.has_value(),
                           r.classes[c].count > 0);
        }
        expect_count("ray_count, by the classes", r.ray_count, classed + r.oracle_invalid);
        expect_count(
            "judged, by the oracle's classes", r.judged,
            std::accumulate(r.oracle_classes.begin(), r.oracle_classes.end(), uint64_t{0}));
        expect_verdict("passed", r.passed, within);
        if (!r.attribution.asked) return;
        uint64_t attributed = r.attribution.unattributed;
        for (const auto& [id, rays] : r.attribution.by_deviation) attributed += rays;
        expect_count("attribution, summed up", attributed, r.errors());
    }

    void image(const ImageRecord& r) {
        expect("psnr_db", r.psnr_db, 20.0 * std::log10(1.0 / r.rmse));
        expect_verdict("passed", r.passed, r.differing_pixels <= r.allowed_pixels);
    }

    void timing(const TimingRecord& r) {
        if (!paired("wall_ms", r.wall_ms.size(), r.oracle_wall_ms.size())) return;
        TimingRecord again = r;
        summarise(again, seed());
        expect("median_ms", r.median_ms, again.median_ms);
        expect("mrays_per_s", r.mrays_per_s, again.mrays_per_s);
        ratio(r, {again.ratio, again.ratio_low, again.ratio_high});
        errors_beside(r);
    }

    /// A speed's errors are those of a check of the same tracer on the same rays.
    void errors_beside(const TimingRecord& r) {
        constexpr auto kEdge = static_cast<size_t>(HitClass::edge);
        std::vector<const CheckRecord*> checks;  // several where its parameters had several values
        for (const CheckRecord& c : results_.checks) {
            const bool of_it = c.scene == r.scene && c.rays == r.rays && c.tracer == r.tracer &&
                               c.ray_count == r.ray_count;
            if (of_it) checks.push_back(&c);
        }
        if (checks.empty()) {
            audit_.underived += 2;
            return;
        }
        const auto match = std::find_if(checks.begin(), checks.end(), [&](const CheckRecord* c) {
            return c->errors() == r.errors && c->classes[kEdge].count == r.edges;
        });
        const CheckRecord& nearest = match == checks.end() ? *checks.front() : **match;
        expect_count("errors", r.errors, nearest.errors());
        expect_count("edges", r.edges, nearest.classes[kEdge].count);
    }

    void sweep(const SweepPoint& r) {
        if (r.oracle_wall_ms.empty()) {
            audit_.underived += 3;  // of a version that did not keep the oracle's samples
            return;
        }
        if (!paired("wall_ms", r.wall_ms.size(), r.oracle_wall_ms.size())) return;
        ratio(r, ratio_of_medians(r.oracle_wall_ms, r.wall_ms, seed()));
    }

    void claim(const ClaimRecord& r) {
        const std::string place = place_;
        for (size_t i = 0; i < r.measurements.size(); ++i) {
            const ClaimMeasurement& m = r.measurements[i];
            if (!m.failure.empty()) continue;
            place_ = fmt::format("{}.measurements[{}]", place, i);
            const size_t samples = m.baseline_samples.size();
            if (!paired("variant", m.variant_samples.size(), std::max<size_t>(samples, 1)))
                continue;
            if (!m.again_samples.empty() && !paired("again", m.again_samples.size(), samples)) {
                continue;
            }
            ClaimMeasurement again = m;
            summarise(again, seed());
            ratio(m, {again.ratio, again.ratio_low, again.ratio_high});
            expect("noise", m.noise, again.noise);
            expect_text("verdict", std::string(to_string(m.verdict)),
                        std::string(to_string(again.verdict)));
        }
        place_ = place;
        const std::vector<Claim>& all = paper_claims();
        const auto known = std::find_if(all.begin(), all.end(),
                                        [&](const Claim& claim) { return claim.id == r.id; });
        if (known == all.end()) {
            audit_.underived += 2;  // a claim of another version: its rule is not known
            return;
        }
        expect_text("verdict", std::string(to_string(r.verdict)),
                    std::string(to_string(verdict_of(r.measurements, known->reading))));
        expect_text("now", r.now, finding_of(*known, r.measurements));
    }

    /// Ratios are to the first record of a scene and its work.
    void ablations() {
        const std::vector<AblationRecord>& all = results_.ablations;
        size_t first = 0;
        for (size_t i = 0; i < all.size(); ++i) {
            if (all[i].scene != all[first].scene || all[i].work != all[first].work) first = i;
            if (!all[i].failure.empty()) continue;
            place_ = fmt::format("ablations[{}]", i);
            std::vector<AblationRecord> again = {all[first], all[i]};
            if (!paired("wall_ms", all[i].wall_ms.size(), all[first].wall_ms.size())) continue;
            if (!paired("device_ms", all[i].device_ms.size(), all[first].device_ms.size())) {
                continue;
            }
            compare_ablations(again, seed());
            ratio(all[i], {again[1].ratio, again[1].ratio_low, again[1].ratio_high});
        }
    }

    void sheet(const PixelSheetRecord& r) {
        std::ifstream file(folder_ / r.file, std::ios::binary);
        const std::string bytes{std::istreambuf_iterator<char>(file), {}};
        expect_text("digest of " + r.file, r.digest, file ? sha256_text(bytes) : "no such file");
    }

    const Results& results_;
    const std::filesystem::path& folder_;
    Audit& audit_;
    std::string place_;
};

}  // namespace

Audit audit(const std::string& text, const std::string& file_name,
            const std::filesystem::path& folder) {
    Audit audit;
    const Results results = results_from_json(text, file_name);
    Auditor(results, folder, audit).run();
    const Seal seal = seal_of(text, file_name);
    audit.sealed = !seal.stored.empty();
    audit.intact = audit.sealed && seal.intact();
    return audit;
}

}  // namespace onepass
