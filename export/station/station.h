#pragma once
// Who observes and under which names: what no log knows and products that are passed on want to say.
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "ingest/flight/problem.h"

namespace quadsonde::product {

/// A WIGOS station identifier: series-issuer-number-local, as 0-20000-0-15015.
/// Source: WMO-No. 49, Vol. I, Attachment; ranges of BUFR Table B 0 01 125 to 0 01 128.
struct WigosId {
  int series = 0, issuer = 0, number = 0;
  std::string local;  ///< 1 to 16 letters and digits
};
/// Empty where the text is none.
std::optional<WigosId> parse_wigos_id(std::string_view text);

/// What is empty is not known: products leave it out or say so, never make it up.
struct Station {
  std::string wigos_id;     ///< "0-454-2-AWSNAMITAMBO"
  std::string name;         ///< of the launch site
  std::string operator_id;  ///< of the WMO UAS demonstration campaign: three digits
  std::string airframe_id;  ///< of the same: one to five letters and digits
  std::string platform_name, platform_type;
  std::string contact_name, contact_email, contact_url;
  std::string publisher_name, publisher_email, publisher_url;
  std::string institution, project, license, references, acknowledgement, naming_authority;
  std::string file;  ///< name of the file it was read from, without folders; empty where there was none

  /// What names the site: the WIGOS identifier, else its name; may be empty.
  const std::string& site() const { return wigos_id.empty() ? name : wigos_id; }
};

/// Reads a station file. Every key may be left out; one that is not known here is refused.
///
///   [station]
///   wigos_id = "0-454-2-AWSNAMITAMBO"   # from the member's focal point for OSCAR/Surface
///   name = "Namitambo"                  # of the launch site
///   [uasdc]                             # WMO UAS demonstration campaign
///   operator_id = "007"                 # three digits, given by the campaign
///   airframe_id = "QS001"               # one to five letters and digits, chosen by the operator
///   [platform]
///   name = "quad-07"                    # left out: as the log names the vehicle
///   type = "quadrotor"                  # left out: multirotor
///   [contact]                           # who made the data
///   name = "Example Person"
///   email = "person@example.org"
///   url = "https://example.org"
///   [publisher]                         # who passes them on: name, email, url
///   [data]
///   institution = "Example Institute"
///   project = "Example project"
///   license = "CC-BY-4.0"
///   references = "https://doi.org/..."
///   acknowledgement = "..."
///   naming_authority = "org.example"    # in whose name the identifiers are unique
///
/// Fails with Kind::usage, naming the line, for anything else, and for identifiers that are none.
ingest::Result<Station> parse_station(std::string_view toml, const std::string& file);
/// The same from a file; Kind::unreadable where it cannot be opened.
ingest::Result<Station> read_station(const std::filesystem::path& path);
/// `auto`: station.toml beside the log where there is one, else a station of which nothing is known.
ingest::Result<Station> choose_station(const std::string& setting, const std::filesystem::path& log);

}  // namespace quadsonde::product
