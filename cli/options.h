#pragma once
// Flags, settings files and --help from one description.
#include <functional>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quadsonde::cli {

struct Option {
  std::string key;          ///< as in a settings file: bin_m
  std::string flag;         ///< as on the command line: --bin-m
  char letter = 0;          ///< short form
  std::string placeholder;  ///< of its value; empty for a switch
  std::string facts;        ///< "m; default 10; 1 to 1000"
  std::string sentence;
  bool is_switch = false, on_by_default = false, repeats = false, is_path = false;
  bool given = false;  ///< on the command line: it wins over the settings file
  /// Takes a value; tells what was expected if it is none of them.
  std::function<std::optional<std::string>(const std::string&)> set;
};

/// A visitor for every describe(): collects the settings it is shown as options that write into them.
class Options {
 public:
  void operator()(const char* name, double& value, double low, double high, const char* sentence);
  void operator()(const char* name, std::optional<double>& value, double low, double high, const char* sentence);
  void operator()(const char* name, bool& value, const char* sentence);
  void operator()(const char* name, std::string& value, const char* placeholder, const char* sentence);
  void operator()(const char* name, std::string& value, std::initializer_list<const char*> words, const char* sentence);
  /// May be given several times, each with one or more values.
  void list(const char* name, std::vector<std::string>& values, const char* placeholder, const char* sentence);

  std::vector<Option>& all() { return options_; }
  const std::vector<Option>& all() const { return options_; }
  Option* find(std::string_view key);
  Option& last() { return options_.back(); }

 private:
  Option& add(const char* name, const char* sentence);
  std::vector<Option> options_;
};

/// The unit that a setting's name ends in: "m" of bin_m, "m/s" of heading_m_s; empty if none.
std::string unit_of(std::string_view name);
/// "--bin-m" of "bin_m" and back.
std::string flag_of(std::string_view key);
std::string key_of(std::string_view flag);
/// The options as --help prints them, within 80 columns.
std::string help_text(const Options& options);

}  // namespace quadsonde::cli
