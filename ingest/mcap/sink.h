#pragma once
// Where a writer's bytes go.
#include <cstdint>
#include <vector>

#include "ingest/flight/bytes.h"

namespace quadsonde::ingest::mcap {

/// Takes bytes in order. write() gives false when they cannot be kept; nothing more is written then.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual bool write(Bytes bytes) = 0;
};

class MemorySink : public Sink {
 public:
  bool write(Bytes bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return true;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

}  // namespace quadsonde::ingest::mcap
