#pragma once
#include "ingest/flight/bytes.h"

namespace quadsonde::ingest {

/// What a file is by its bytes; its name never counts.
enum class Container {
  unknown,  ///< binary, and nobody's
  text,     ///< text that no reader knows (a table may still be mapped by the user)
  mcap,
  ulog,
  dataflash,
  mavlink,
  paparazzi_data,
  paparazzi_log,  ///< the XML that belongs to a .data
  table,
  dji_native,  ///< a recorder file of the aircraft (.DAT) or of the app (.txt), encrypted
  compressed
};

Container sniff(Bytes bytes);

}  // namespace quadsonde::ingest
