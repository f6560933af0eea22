#include "export/validate/validate.h"

#include "cli/verbs/answers.h"

namespace quadsonde::cli {
namespace {

class ValidateVerb : public Verb {
 public:
  std::string name() const override { return "validate"; }
  std::string usage() const override { return "FILE..."; }
  std::string summary() const override { return "a netCDF, BUFR or MCAP file against the conventions it claims"; }
  void describe(Options&) override {}

  int run(const Call& call) override {
    std::vector<std::string> texts;
    bool failed = false, broken = false;
    for (const auto& input : call.inputs) {
      const auto answer = product::validate_file(input);
      if (!answer) {
        call.console.error(answer.error());
        failed = true;
        continue;
      }
      broken = broken || !answer->conformant();
      texts.push_back(wants_json(call) ? product::validation_json(*answer) : product::validation_text(*answer));
    }
    if (texts.empty()) return no_answer;
    if (const int given = give(call, texts); given != complete) return given;
    return failed || broken ? with_doubts : complete;
  }
};

}  // namespace

std::unique_ptr<Verb> make_validate_verb() { return std::make_unique<ValidateVerb>(); }

}  // namespace quadsonde::cli
