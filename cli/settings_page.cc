// Prints doc/settings.md: every setting once, with the verbs that take it, from the descriptions that the parser uses.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <map>

#include "cli/verb.h"

namespace quadsonde::cli {
namespace {

/// One row of the page: a setting as some verbs have it. The same name with another meaning is another row.
struct Row {
  Option option;
  std::vector<std::string> verbs;
};

std::vector<Row> rows_of(const std::vector<std::unique_ptr<Verb>>& verbs) {
  std::vector<Row> rows;
  for (const auto& verb : verbs) {
    Options options;
    verb->describe(options);
    for (const auto& option : options.all()) {
      const auto same = std::find_if(rows.begin(), rows.end(), [&](const Row& row) {
        return row.option.key == option.key && row.option.sentence == option.sentence &&
               row.option.facts == option.facts;
      });
      if (same == rows.end())
        rows.push_back({option, {verb->name()}});
      else
        same->verbs.push_back(verb->name());
    }
  }
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.option.key < b.option.key; });
  return rows;
}

/// Bars would end a cell of the table, angle brackets would begin an HTML tag.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|')
      escaped += "\\|";
    else if (c == '<')
      escaped += "&lt;";
    else
      escaped += c;
  }
  return escaped;
}

std::string flag_cell(const Option& option) {
  const auto flag = option.is_switch && option.on_by_default ? "--[no-]" + option.flag.substr(2) : option.flag;
  const auto value = option.placeholder.empty() ? "" : " " + option.placeholder + (option.repeats ? "..." : "");
  return "`" + cell(flag + value) + "`";
}

std::string page() {
  const auto verbs = all_verbs();
  std::string text =
      "# Which settings are there?\n\n"
      "Every setting has a default that is right for most flights. Each may be given as a flag, or under its name "
      "with\n"
      "`_` for `-` in `quadsonde.toml` beside the input or in the file given by `--settings`; a flag wins.\n"
      "This page is made from the descriptions that the parser uses (`cmake --build --preset dev --target\n"
      "settings_page_doc`). Every verb also takes `-o, --output`, `--json`, `--force`, `--quiet` and `--settings`.\n\n"
      "| setting | unit, default, range | what it does | verbs |\n| --- | --- | --- | --- |\n";
  for (const auto& row : rows_of(verbs))
    text += fmt::format("| {} | {} | {} | {} |\n", flag_cell(row.option), cell(row.option.facts),
                        cell(row.option.sentence), fmt::join(row.verbs, ", "));
  return text;
}

}  // namespace
}  // namespace quadsonde::cli

int main() { return std::fputs(quadsonde::cli::page().c_str(), stdout) < 0; }
