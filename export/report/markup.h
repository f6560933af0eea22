#pragma once
// XML and HTML that cannot be malformed by what stands in a log: every text and attribute is escaped here, elements
// are closed by their scope.
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace quadsonde::product {

/// Escapes & < > " ' and replaces what XML 1.0 does not allow (control characters, bytes that are no UTF-8).
std::string escaped(std::string_view text);

struct Attribute {
  Attribute(std::string_view n, std::string_view v) : name(n), value(v) {}
  Attribute(std::string_view n, const char* v) : name(n), value(v) {}
  Attribute(std::string_view n, const std::string& v) : name(n), value(v) {}
  /// Up to two decimals, without trailing zeros; anything not finite becomes 0.
  Attribute(std::string_view n, double v);
  Attribute(std::string_view n, int v) : Attribute(n, static_cast<double>(v)) {}
  std::string name, value;
};
using Attributes = std::initializer_list<Attribute>;

/// A number as SVG attributes have it.
std::string coordinate(double value);

class Markup {
 public:
  /// Closes its element when it goes out of scope.
  class Scope {
   public:
    Scope(Scope&& other) noexcept : markup_(other.markup_) { other.markup_ = nullptr; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;
    Scope& operator=(Scope&&) = delete;
    ~Scope() {
      if (markup_) markup_->close();
    }

   private:
    friend class Markup;
    explicit Scope(Markup* markup) : markup_(markup) {}
    Markup* markup_;
  };

  [[nodiscard]] Scope element(std::string_view name, Attributes attributes = {});
  /// An element without content: <name .../>.
  void empty(std::string_view name, Attributes attributes = {});
  /// <name ...>text</name> on one line.
  void leaf(std::string_view name, std::string_view text, Attributes attributes = {});
  void text(std::string_view text) { out_ += escaped(text); }
  /// Markup made by another Markup, or a fixed text of this program; never anything from outside.
  void trusted(std::string_view markup) { out_ += markup; }
  const std::string& str() const { return out_; }

 private:
  void start(std::string_view name, Attributes attributes);
  void close();
  std::string out_;
  std::vector<std::string> open_;
};

}  // namespace quadsonde::product
