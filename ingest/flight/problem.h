#pragma once
// What went wrong, as data: what, where, and what the user can do next.
#include <cstdint>
#include <optional>
#include <string>
#include <tl/expected.hpp>

namespace quadsonde::ingest {

enum class Kind {
  usage,           ///< the request itself is wrong (exit 2)
  unreadable,      ///< the file cannot be opened or read
  not_a_log,       ///< no reader knows these bytes
  unsupported,     ///< known, but not something we read (encrypted, newer, another vehicle)
  truncated,       ///< the file ends in the middle of something
  damaged,         ///< bytes that contradict their own format
  missing,         ///< a stream or column that is needed is not there
  doubtful,        ///< readable, but not believable
  inconsistent,    ///< measurements that contradict each other
  limit,           ///< larger than what we are willing to hold
  no_answer,       ///< everything was read, and the question still has no answer
  write_failed     ///< an output could not be written
};

struct Where {
  std::string file;
  std::optional<std::uint64_t> byte;
  std::optional<std::uint64_t> line;  ///< first line is 1
  std::string topic;                  ///< topic, message type or column
};

struct Problem {
  Kind kind = Kind::damaged;
  std::string what;  ///< what is wrong, and what was expected
  Where where;
  std::string hint;  ///< the next step
};

template <class T>
using Result = tl::expected<T, Problem>;

/// "log.ulg, byte 17, topic vehicle_attitude"; empty when nothing is known.
std::string to_string(const Where& where);
/// "WHERE: WHAT. HINT" on one line.
std::string to_string(const Problem& problem);

inline tl::unexpected<Problem> fail(Problem problem) { return tl::unexpected<Problem>(std::move(problem)); }
inline tl::unexpected<Problem> fail(Kind kind, std::string what, Where where = {}, std::string hint = {}) {
  return fail(Problem{kind, std::move(what), std::move(where), std::move(hint)});
}

/// How a reader treats damage. strict: the first Problem ends it. tolerant: the damaged record is dropped and
/// the Problem kept. salvage: also searches for the next sound record after lost structure.
enum class Reading { strict, tolerant, salvage };

}  // namespace quadsonde::ingest
