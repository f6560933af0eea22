// Build step: turns the coefficients of a World Magnetic Model (wmmYEAR.txt beside this file) into what
// GeographicLib::MagneticModel reads.
//   make_models wmm2025.txt FOLDER wmm2025
// Source of the format: GeographicLib manual, "The format of the magnetic model files".
#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

constexpr int degree = 12;

[[noreturn]] void give_up(const std::string& what) {
  std::fprintf(stderr, "make_models: %s\n", what.c_str());
  std::exit(1);
}

struct Term {
  double g = 0, h = 0, g_dot = 0, h_dot = 0;
};
struct Model {
  int epoch = 0, from = 0, to = 0;
  std::map<std::pair<int, int>, Term> terms;
};

Model read(const std::string& file) {
  std::ifstream in(file);
  if (!in) give_up(file + " cannot be read");
  Model model;
  std::string line;
  while (std::getline(in, line)) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream fields(line);
    fields.imbue(std::locale::classic());
    if (!model.epoch) {
      if (!(fields >> model.epoch >> model.from >> model.to)) give_up("the line of the epoch is none: " + line);
      continue;
    }
    int n = 0, m = 0;
    Term t;
    if (!(fields >> n >> m >> t.g >> t.h >> t.g_dot >> t.h_dot) || n < 1 || n > degree || m < 0 || m > n)
      give_up("this line holds no term: " + line);
    model.terms[{n, m}] = t;
  }
  if (model.terms.size() != degree * (degree + 3) / 2) give_up("terms are missing");
  return model;
}

template <class Bits>
void put(std::string& bytes, Bits bits) {
  for (std::size_t i = 0; i < sizeof(Bits); ++i) bytes.push_back(static_cast<char>(bits >> (8 * i) & 0xff));
}

/// N and M, then the cosines by columns of one order, then the sines without order 0.
void put_set(std::string& bytes, const Model& model, double Term::*cosine, double Term::*sine) {
  put(bytes, std::uint32_t{degree}), put(bytes, std::uint32_t{degree});
  for (int part = 0; part < 2; ++part)
    for (int m = part; m <= degree; ++m)
      for (int n = m; n <= degree; ++n) {
        const auto term = model.terms.find({n, m});
        const double value = term == model.terms.end() ? 0 : term->second.*(part ? sine : cosine);
        put(bytes, std::bit_cast<std::uint64_t>(value));
      }
}

}  // namespace

int main(int count, char** arguments) {
  if (count != 4) give_up("wmmYEAR.txt FOLDER NAME");
  const auto model = read(arguments[1]);
  const std::string base = std::string(arguments[2]) + "/" + arguments[3] + ".wmm";
  const std::string id = "WMM" + std::to_string(model.epoch) + "Q";
  std::string bytes = id;
  put_set(bytes, model, &Term::g, &Term::h);
  put_set(bytes, model, &Term::g_dot, &Term::h_dot);
  std::ofstream cof(base + ".cof", std::ios::binary), text(base);
  cof << bytes;
  text << "WMMF-1\n# Made from " << arguments[3] << ".txt of quadsonde.\n"
       << "Name " << arguments[3] << "\nDescription World Magnetic Model " << model.epoch << "\nReleaseDate "
       << model.epoch << "-01-01\nRadius 6371200\nType Linear\nEpoch " << model.epoch << "\nDeltaEpoch "
       << model.to - model.epoch << "\nNumModels 1\nMinTime " << model.from << "\nMaxTime " << model.to
       << "\nMinHeight -1000\nMaxHeight 850000\nNormalization Schmidt\nByteOrder Little\nID " << id << "\n";
  cof.close(), text.close();
  if (!cof || !text) give_up("an output cannot be written");
}
