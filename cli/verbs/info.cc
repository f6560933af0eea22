#include <algorithm>

#include "cli/verbs/answers.h"
#include "export/pipeline/inspect.h"

namespace quadsonde::cli {
namespace {

class InfoVerb : public Verb {
 public:
  std::string name() const override { return "info"; }
  std::string usage() const override { return "LOG..."; }
  std::string summary() const override { return "what a log holds, and whether it can give wind"; }
  void describe(Options& options) override {
    product::describe(input_, options);
    profiles::describe(profile_, options);
  }

  int run(const Call& call) override {
    std::vector<std::string> answers;
    int code = complete;
    bool failed = false;
    for (const auto& input : call.inputs) {
      const auto log = product::load_log(input, input_, call.control);
      if (!log) {
        call.console.error(log.error());
        failed = true;
        if (log.error().kind == ingest::Kind::usage) code = wrong_usage;
        continue;
      }
      const auto facts = product::inspect(*log, profile_.bin_m);
      call.console.warnings(facts.problems);
      if (!facts.problems.empty()) code = std::max(code, with_doubts);
      answers.push_back(wants_json(call) ? product::info_json(facts) : product::info_text(facts));
    }
    if (answers.empty()) return code == wrong_usage ? wrong_usage : no_answer;
    const int written = give(call, answers);
    return written != complete ? written : failed ? with_doubts : code;
  }

 private:
  product::InputSettings input_;
  profiles::ProfileSettings profile_;
};

}  // namespace

std::unique_ptr<Verb> make_info_verb() { return std::make_unique<InfoVerb>(); }

}  // namespace quadsonde::cli
