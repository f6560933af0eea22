#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <set>

#include "cli/interrupt.h"
#include "cli/settings_file.h"
#include "cli/verb.h"
#include "export/report/text_answer.h"
#include "export/version.h"

namespace quadsonde::cli {
namespace {

using ingest::Kind;
using ingest::Problem;

/// "add, list, query": the second words of the verbs that begin with this one.
std::string actions_of(const std::string& group) {
  std::string actions;
  for (const auto& verb : all_verbs())
    if (const auto name = verb->name(); name.starts_with(group + " "))
      actions += (actions.empty() ? "" : ", ") + name.substr(group.size() + 1);
  return actions;
}

std::string group_overview(const std::string& group) {
  std::string text;
  for (const auto& verb : all_verbs())
    if (verb->name().starts_with(group + " "))
      text += product::wrapped(fmt::format("quadsonde {} {}", verb->name(), verb->usage()), 79, 4) + "\n" +
              product::wrapped("    " + verb->summary(), 79, 4) + "\n";
  return text + fmt::format("\nquadsonde {} ACTION --help tells the settings of an action.\n", group);
}

std::string overview() {
  std::string text =
      "quadsonde: vertical wind profiles from multirotor flight logs\n\nquadsonde VERB INPUT... -o OUTPUT\n\n";
  std::set<std::string> groups;
  for (const auto& verb : all_verbs()) {
    const auto name = verb->name();
    const auto group = name.substr(0, name.find(' '));
    if (group == name)
      text += fmt::format("  {:<10} {}\n", name, verb->summary());
    else if (groups.insert(group).second)
      text += fmt::format("  {:<10} {}\n", group, actions_of(group));
  }
  return text + "\nquadsonde VERB --help tells its settings; quadsonde --version the version.\n";
}

std::string verb_help(const Verb& verb, const Options& options) {
  const auto foot = product::wrapped(
      "Every setting may stand under its name, with _ for -, in quadsonde.toml beside the input or in the file given "
      "by "
      "--settings; a flag wins over it.");
  return fmt::format("quadsonde {} {}\n{}\n\n{}\n{}\n", verb.name(), verb.usage(), product::wrapped(verb.summary()),
                     help_text(options), foot);
}

std::set<std::string> every_key() {
  std::set<std::string> keys;
  for (const auto& verb : all_verbs()) {
    Options options;
    verb->describe(options);
    for (const auto& option : options.all()) keys.insert(option.key);
  }
  return keys;
}

/// What the command line gave to one option, in its order.
struct Given {
  Option* option = nullptr;
  std::vector<std::string> values;
  bool on = false, off = false;
};

/// Hands argv to CLI11 and the values to the options. Empty if all went well.
std::optional<Problem> parse(int argc, char** argv, const Verb& verb, Options& options,
                             std::vector<std::string>& inputs, bool& help) {
  CLI::App app;
  app.set_help_flag();
  app.add_flag("-h,--help", help);
  app.add_option("input", inputs);
  std::vector<Given> given(options.all().size());
  for (std::size_t i = 0; i < given.size(); ++i) {
    auto& g = given[i];
    g.option = &options.all()[i];
    const std::string names = (g.option->letter ? fmt::format("-{},", g.option->letter) : "") + g.option->flag;
    if (g.option->is_switch) {
      app.add_flag(names, g.on);
      if (g.option->on_by_default) app.add_flag("--no-" + g.option->flag.substr(2), g.off);
    } else {
      auto* added = app.add_option(names, g.values)->expected(1);
      if (g.option->repeats) added->expected(1, CLI::detail::expected_max_vector_size);
      // Without this a value's follower, the input itself, would be taken for a second value.
      if (!g.option->repeats) added->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::Throw);
    }
  }
  const auto hint = fmt::format("see `quadsonde {} --help`", verb.name());
  try {
    app.parse(argc - 1, argv + 1);
  } catch (const CLI::ParseError& error) {
    return Problem{Kind::usage, error.what(), {}, hint};
  }
  for (auto& g : given) {
    if (g.on) g.values.push_back("true");
    if (g.off) g.values.push_back("false");
    g.option->given = !g.values.empty();
    for (const auto& value : g.values)
      if (const auto expected = g.option->set(value))
        return Problem{Kind::usage, fmt::format("{} {}: {}", g.option->flag, value, *expected), {}, hint};
  }
  return std::nullopt;
}

std::optional<Problem> read_settings(const CommonSettings& common, const std::vector<std::string>& inputs,
                                     Options& options, Console& console) {
  auto file =
      common.settings.empty() ? settings_beside(inputs.front()) : std::optional<std::filesystem::path>(common.settings);
  if (!file) return std::nullopt;
  if (auto applied = apply_settings_file(*file, options, every_key()); !applied) return applied.error();
  if (common.settings.empty()) console.note("settings from " + file->string());
  return std::nullopt;
}

int call_verb(Verb& verb, int argc, char** argv) {
  Console console;
  Options options;
  CommonSettings common;
  describe(common, options);
  verb.describe(options);
  std::vector<std::string> inputs;
  bool help = false;
  const auto fail_with = [&](const Problem& problem) {
    console.error(problem);
    return wrong_usage;
  };
  if (const auto problem = parse(argc, argv, verb, options, inputs, help)) return fail_with(*problem);
  if (help) {
    console.print(verb_help(verb, options));
    return console.flush() ? complete : no_answer;
  }
  const auto hint = fmt::format("quadsonde {} {}", verb.name(), verb.usage());
  if (inputs.empty()) return fail_with({Kind::usage, "an input is missing", {}, hint});
  if (inputs.size() > verb.most_inputs()) return fail_with({Kind::usage, "too many inputs", {}, hint});
  console.set_quiet(common.quiet);
  if (const auto problem = read_settings(common, inputs, options, console)) return fail_with(*problem);
  console.set_quiet(common.quiet);
  const int code = run_interruptible(
      [&](const product::Control& control) {
        return verb.run({{inputs.begin(), inputs.end()}, common, console, control});
      },
      [&](std::string_view stage, double share) { console.progress(stage, share); });
  console.clear_progress();
  if (!console.flush() && code != interrupted) {
    console.error({Kind::write_failed, "standard output cannot take the answer", {}, "write it to a file with -o"});
    return no_answer;
  }
  return code;
}

}  // namespace

void describe(CommonSettings& s, Options& options) {
  options("output", s.output, "PATH",
          "Where the result goes; its ending decides the format. Left out: a short answer is printed.");
  options.last().letter = 'o';
  options("json", s.json, "Print the answer as JSON.");
  options("force", s.force, "Overwrite outputs that are already there.");
  options("quiet", s.quiet, "No notes, no warnings, no progress bar.");
  options("settings", s.settings, "FILE.toml", "Settings file; left out, quadsonde.toml beside the input.");
}

int run_program(int argc, char** argv) {
  const std::string first = argc > 1 ? argv[1] : "";
  Console console;
  if (first.empty() || first == "--help" || first == "-h" || first == "help") {
    console.print(overview());
    console.flush();
    return first.empty() ? wrong_usage : complete;
  }
  if (first == "--version") {
    console.print(fmt::format("quadsonde {}\n", product::version()));
    return console.flush() ? complete : no_answer;
  }
  const std::string second = argc > 2 ? argv[2] : "";
  for (const auto& verb : all_verbs()) {
    const bool two_words = verb->name() == first + " " + second;
    if (verb->name() != first && !two_words) continue;
    try {
      return two_words ? call_verb(*verb, argc - 1, argv + 1) : call_verb(*verb, argc, argv);
    } catch (const std::exception& error) {
      console.error({Kind::no_answer, error.what(), {}, "this is a fault of quadsonde: please report it with the log"});
      return no_answer;
    }
  }
  if (const auto actions = actions_of(first); !actions.empty()) {
    const bool asked = second == "--help" || second == "-h" || second == "help";
    if (asked || second.empty()) {
      console.print(group_overview(first));
      console.flush();
      return asked ? complete : wrong_usage;
    }
    console.error({Kind::usage, fmt::format("{} has no action \"{}\", but {}", first, second, actions), {},
                   fmt::format("see `quadsonde {} --help`", first)});
    return wrong_usage;
  }
  console.error({Kind::usage, fmt::format("there is no verb \"{}\"", first), {}, "see `quadsonde --help`"});
  return wrong_usage;
}

}  // namespace quadsonde::cli
