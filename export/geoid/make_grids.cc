// Build step: turns the EGM96 grid of proj-data (egm96_15.gtx, 0.25 degrees) into what quadsonde reads.
//   make_grids egm96_15.gtx OUT.pgm OUT.inc
// OUT.pgm is the whole grid in the format of GeographicLib::Geoid, OUT.inc every fourth row and column of the same
// numbers as C++ initialisers.
// Sources: .gtx is NOAA's vertical grid (PROJ manual, "Vertical grids"): big-endian, 40 bytes of header (lat, lon of
// the first node, steps, rows, columns), rows from south to north; the PGM and the comments it must hold are in the
// GeographicLib manual, "The format of the geoid files".
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace {

constexpr double offset = -108, scale = 0.003;  // GeographicLib's own for EGM96: -108 m to 88.6 m
constexpr std::size_t rows = 721, columns = 1440, header_size = 40;

[[noreturn]] void give_up(const std::string& what) {
  std::fprintf(stderr, "make_grids: %s\n", what.c_str());
  std::exit(1);
}

template <class Bits>
Bits big_endian(const std::string& bytes, std::size_t at) {
  Bits bits = 0;
  for (std::size_t i = 0; i < sizeof(Bits); ++i)
    bits = static_cast<Bits>(bits << 8 | static_cast<std::uint8_t>(bytes[at + i]));
  return bits;
}
double double_at(const std::string& bytes, std::size_t at) {
  return std::bit_cast<double>(big_endian<std::uint64_t>(bytes, at));
}

/// Pixels from the north pole south, each row from 0 degrees east: GeographicLib's order.
std::vector<std::uint16_t> pixels_of(const std::string& gtx) {
  if (gtx.size() != header_size + rows * columns * 4) give_up("this is not the 0.25 degree grid: its size differs");
  if (double_at(gtx, 0) != -90 || double_at(gtx, 8) != -180 || double_at(gtx, 16) != 0.25 ||
      double_at(gtx, 24) != 0.25 || big_endian<std::uint32_t>(gtx, 32) != rows ||
      big_endian<std::uint32_t>(gtx, 36) != columns)
    give_up("this is not the 0.25 degree grid: its header differs");
  std::vector<std::uint16_t> pixels;
  pixels.reserve(rows * columns);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t south_up = rows - 1 - row, from_180_west = (column + columns / 2) % columns;
      const std::size_t at = header_size + 4 * (south_up * columns + from_180_west);
      const double height = std::bit_cast<float>(big_endian<std::uint32_t>(gtx, at));
      if (!(height >= offset && height <= offset + scale * 65535)) give_up("a height of the grid is impossible");
      pixels.push_back(static_cast<std::uint16_t>(std::lround((height - offset) / scale)));
    }
  }
  return pixels;
}

void write_pgm(std::ofstream& out, const std::vector<std::uint16_t>& pixels) {
  // The comments that name its errors and its date are left out: GeographicLib then says that they are not known.
  out << "P5\n# Geoid file in PGM format for the GeographicLib::Geoid class\n"
      << "# Description WGS84 EGM96, 15-minute grid\n"
      << "# Offset " << offset << "\n# Scale " << scale << "\n# Origin 90N 0E\n# AREA_OR_POINT Point\n"
      << "# Vertical_Datum WGS84\n"
      << columns << " " << rows << "\n65535\n";
  std::string bytes;
  for (const auto pixel : pixels) {
    bytes.push_back(static_cast<char>(pixel >> 8));
    bytes.push_back(static_cast<char>(pixel & 0xff));
  }
  out << bytes;
}

void write_coarse(std::ofstream& out, const std::vector<std::uint16_t>& pixels) {
  for (std::size_t row = 0; row < rows; row += 4) {
    for (std::size_t column = 0; column < columns; column += 4) out << pixels[row * columns + column] << ",";
    out << "\n";
  }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) give_up("egm96_15.gtx OUT.pgm OUT.inc");
  std::ifstream in(arguments[1], std::ios::binary);
  const std::string gtx{std::istreambuf_iterator<char>(in), {}};
  const auto pixels = pixels_of(gtx);
  std::ofstream pgm(arguments[2], std::ios::binary), coarse(arguments[3], std::ios::binary);
  write_pgm(pgm, pixels);
  write_coarse(coarse, pixels);
  pgm.close(), coarse.close();
  if (!pgm || !coarse) give_up("an output cannot be written");
}
