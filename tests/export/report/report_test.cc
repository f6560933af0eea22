#include "export/report/report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/export/made_up.h"
#include "tests/export/report/xml_check.h"

namespace quadsonde::product {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Made {
  estimator::WindSeries series = support::made_up_series();
  profiles::WindProfile profile = support::made_up_profile();
  Report report;
  Made() {
    report.title = {"a.ulg", 1,      1,    ingest::UtcTime{1'750'000'000'000'000'000}, ingest::GeoPoint{43.5, 1.4},
                    460,     "quad", "PX4"};
    report.series = &series, report.profile = &profile;
    report.source = support::made_up_source();
  }
};

TEST(Report, AnswersFirstAndTellsWhereItComesFrom) {
  const Made made;
  const auto html = report_html(made.report);
  const auto answer = html.find(
      "The wind was 2.6 m/s from 252 deg (west-southwest) at 15 m and 7.0 m/s from 272 deg (west) at 235 m above "
      "take-off.");
  ASSERT_NE(answer, std::string::npos);
  EXPECT_LT(answer, html.find("<table"));
  EXPECT_LT(html.find("<table"), html.find("<svg"));
  EXPECT_LT(html.find("<svg"), html.find("Where it comes from"));
  EXPECT_THAT(html, HasSubstr("00ff"));
  EXPECT_THAT(html, HasSubstr("bin_m = 10"));
  EXPECT_THAT(html, HasSubstr("a record is cut"));
}

TEST(Report, LoadsAndRunsNothing) {
  const Made made;
  const auto html = report_html(made.report);
  EXPECT_THAT(html, HasSubstr("default-src &#39;none&#39;; style-src &#39;unsafe-inline&#39;"));
  for (const auto* word : {"<script", "href=", "src=", "@import", "onload"})
    EXPECT_THAT(html, Not(HasSubstr(word))) << word;
}

TEST(Report, CannotBeBrokenByNamesInTheLog) {
  Made made;
  made.report.title.vehicle = "</p><script>alert(1)</script>";
  made.report.source.file = "x\"><img src=y>";
  made.report.source.problems[0].what = "<svg onload=z> & more";
  const auto html = report_html(made.report);
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_THAT(html, Not(HasSubstr("<img")));
  EXPECT_EQ(support::xml_fault(html), std::nullopt);
}

TEST(Report, OfAFlightWithoutHeightsShowsTheWindAlongItOnly) {
  Made made;
  made.report.profile = nullptr;
  const auto html = report_html(made.report);
  EXPECT_THAT(html, HasSubstr("Along the flight"));
  EXPECT_THAT(html, Not(HasSubstr("<table")));
}

}  // namespace
}  // namespace quadsonde::product
