#include "export/report/markup.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/export/report/xml_check.h"

namespace quadsonde::product {
namespace {

TEST(Markup, EscapesEveryTextAndAttribute) {
  Markup m;
  {
    const auto g = m.element("g", {{"id", "a\"><script>"}});
    m.leaf("text", "<b> & 'c' \"d\"");
  }
  EXPECT_EQ(m.str(),
            "<g id=\"a&quot;&gt;&lt;script&gt;\">\n<text>&lt;b&gt; &amp; &#39;c&#39; &quot;d&quot;</text>\n</g>\n");
}

TEST(Markup, ReplacesWhatXmlDoesNotAllow) {
  EXPECT_EQ(escaped(std::string("a\0b\x1b", 4)),
            "a\xEF\xBF\xBD"
            "b\xEF\xBF\xBD");
  EXPECT_EQ(escaped("\xC3\xA9 \xC3 \xFF \xED\xA0\x80"),
            "\xC3\xA9 \xEF\xBF\xBD \xEF\xBF\xBD \xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD")
      << "sound UTF-8 stays; cut, foreign and surrogate bytes do not";
  EXPECT_EQ(escaped("\xF0\x9F\x8C\xAC"), "\xF0\x9F\x8C\xAC");
}

TEST(Markup, PrintsCoordinatesShortAndFinite) {
  EXPECT_EQ(coordinate(12.5), "12.5");
  EXPECT_EQ(coordinate(-0.001), "0");
  EXPECT_EQ(coordinate(100), "100");
  EXPECT_EQ(coordinate(std::numeric_limits<double>::quiet_NaN()), "0");
}

TEST(XmlCheck, FindsWhatIsNotWellFormed) {
  for (const auto* bad : {"<a>", "<a></b>", "<a>&</a>", "<a b=\"<\"/>", "</a>", "<a"})
    EXPECT_TRUE(support::xml_fault(bad)) << bad;
  EXPECT_FALSE(support::xml_fault("<a b=\"&lt;\">x &amp; y<c/></a>"));
}

}  // namespace
}  // namespace quadsonde::product
