#include "compare/rungs.h"

#include <fmt/format.h>

#include "compare/experiments.h"

namespace onepass {

RungRecord empty_record(double knob, const std::string& label, const Contestant& contestant) {
    RungRecord record;
    record.knob = knob;
    record.label = label;
    record.tracer = contestant.entry->info.name;
    record.setting = params_text(contestant.params);
    return record;
}

void add_failure(RungRecord& record, std::string_view kind) {
    for (FailureCount& failure : record.failures) {
        if (failure.kind != kind) continue;
        ++failure.count;
        return;
    }
    record.failures.push_back({std::string(kind), 1});
}

void give_up(RungRecord& record, size_t trials) {
    record.trials = trials;
    record.failures = {{kGaveUp, trials}};
}

std::string refusal_text(const Error& error) {
    return fmt::format("{}: {}", error.parts().where, error.parts().got);
}

Hit true_hit(const Verdict& verdict) {
    return {.t = static_cast<float>(verdict.true_t),
            .prim_id = verdict.true_prim_id,
            .inst_id = verdict.true_inst_id};
}

}  // namespace onepass
