#pragma once
// Several files that appear together or not at all.
#include <filesystem>
#include <string_view>
#include <vector>

#include "export/atomic_file.h"
#include "export/mcap/flight_to_mcap.h"
#include "export/pipeline/control.h"
#include "ingest/flight/flight.h"
#include "ingest/flight/truth.h"

namespace quadsonde::product {

/// Each file is written beside its target; commit() renames them, one after the other. Without commit() nothing of
/// them stays, nor a folder that was made for them. Nothing is begun once `stop` is set.
class Outputs {
 public:
  Outputs(bool overwrite, Control control);
  Outputs(const Outputs&) = delete;
  Outputs& operator=(const Outputs&) = delete;
  ~Outputs();

  /// Makes a folder and those above it, where they are not there.
  ingest::Result<void> make_folder(const std::filesystem::path& folder);
  ingest::Result<void> add(const std::filesystem::path& path, std::string_view content);
  /// A flight as MCAP, with what was computed from it.
  ingest::Result<void> add_flight(const std::filesystem::path& path, const ingest::Flight& flight,
                                  const ingest::Truth& truth = {}, const FlightProducts& products = {});
  ingest::Result<void> commit();

 private:
  ingest::Result<AtomicFile*> begin(const std::filesystem::path& path);
  bool overwrite_, committed_ = false;
  Control control_;
  std::vector<AtomicFile> files_;
  std::vector<std::filesystem::path> made_folders_;
};

}  // namespace quadsonde::product
