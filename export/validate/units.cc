#include "export/validate/units.h"

#include <udunits2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "export/isolated.h"

namespace quadsonde::product {
namespace {

using ingest::fail;
using ingest::Kind;

// Longer ones are no units, and the parser of UDUNITS need not see them.
constexpr std::size_t longest = 256;

struct FreeUnit {
  void operator()(ut_unit* unit) const { ut_free(unit); }
};
struct FreeConverter {
  void operator()(cv_converter* converter) const { cv_free(converter); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;

/// Runs in the child, which ends before anything needs to be freed.
class Database {
 public:
  Database() {
    ut_set_error_message_handler(ut_ignore);
    system_ = ut_read_xml(nullptr);
  }
  bool there() const { return system_ != nullptr; }

  UnitAnswer answer(const std::string& units, const std::string& other) {
    UnitAnswer said;
    const auto one = parse(units);
    said.known = one != nullptr;
    const auto two = parse(other);
    if (!one || !two) return said;
    said.convertible = ut_are_convertible(one.get(), two.get()) != 0;
    if (!said.convertible) return said;
    const std::unique_ptr<cv_converter, FreeConverter> converter(ut_get_converter(one.get(), two.get()));
    constexpr std::array<double, 3> samples{0, 1, 1000};
    said.same = converter && std::all_of(samples.begin(), samples.end(), [&](double x) {
                  return std::abs(cv_convert_double(converter.get(), x) - x) <= 1e-9 * std::max(1.0, x);
                });
    return said;
  }

 private:
  Unit parse(std::string text) {
    const auto begin = text.find_first_not_of(' '), end = text.find_last_not_of(' ');
    if (begin == std::string::npos || text.size() > longest) return nullptr;
    return Unit(ut_parse(system_, text.substr(begin, end - begin + 1).c_str(), UT_UTF8));
  }
  ut_system* system_ = nullptr;
};

}  // namespace

ingest::Result<void> Units::answer() {
  if (questions_.empty()) return {};
  const auto said = isolated([&] {
    Database database;
    if (!database.there()) return std::string("-");
    std::string letters = "+";
    for (const auto& [units, other] : questions_) {
      const auto a = database.answer(units, other);
      letters += static_cast<char>('0' + (a.known ? 1 : 0) + (a.convertible ? 2 : 0) + (a.same ? 4 : 0));
    }
    return letters;
  });
  if (!said) return fail(said.error());
  if (said->size() != questions_.size() + 1 || said->front() != '+')
    return fail(Kind::no_answer, "UDUNITS finds no database of units", {}, "install libudunits2-data");
  std::size_t i = 0;
  for (const auto& question : questions_) {
    const int bits = (*said)[++i] - '0';
    answers_[question] = {(bits & 1) != 0, (bits & 2) != 0, (bits & 4) != 0};
  }
  return {};
}

UnitAnswer Units::of(const std::string& units, const std::string& other) const {
  const auto found = answers_.find({units, other});
  return found == answers_.end() ? UnitAnswer{} : found->second;
}

}  // namespace quadsonde::product
