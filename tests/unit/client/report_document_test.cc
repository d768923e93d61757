// The pages of a report, whatever it says: words are escaped, the HTML is well-formed, those who do
// not see it are told as much, and every figure carries where it comes from.

#include <gmock/gmock.h>
#include <libxml/parser.h>
#include <libxml/xpath.h>

#include <memory>

#include "client/cpp/report/document_csv.h"
#include "client/cpp/report/document_html.h"
#include "client/cpp/report/language.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

ReportDocument make_document() {
  ReportDocument document;
  document.title = "Fat & \"skin\" <1>";
  document.notice = "Not a \"device\".";
  document.running_head = "patient </style>";
  document.page_of = "page $0 of $1";
  Table table{"t", "Volumes", {"zone", "mL"}, {}};
  table.rows.push_back({Cell{{{"a<b"}}}, Cell{{{"1.23", Figure{"/volumes/0", 1.234, 1.0, "mL"}}, {" (of 2)"}}}});
  table.rows.push_back({Cell{{{"share"}}}, Cell{{{"50", Figure{"/share", 0.5, 100.0, "%"}}}}});
  PictureTable pictures{"p", "Views", {"view", "before"}, {{"front", {{"png bytes", "The face \"before\""}}}}};
  Maps maps{{Map{{"png", "a map"},
                 "Pressure",
                 ColourScale{"movement", "mm", 0.0, 2.5, 1, {"#ffffff", "#000000"}},
                 {{"#aa0000", "above 30 mmHg"}}}}};
  document.sections = {{"s", "One & all", {Paragraph{{{"fünf < 6"}}, "de"}, table, pictures, maps}, true}};
  return document;
}

using Xml = std::unique_ptr<xmlDoc, decltype(&xmlFreeDoc)>;

Xml parse(const std::string& html) {
  return {xmlReadMemory(html.data(), static_cast<int>(html.size()), "report.html", "UTF-8", XML_PARSE_NONET),
          &xmlFreeDoc};
}

/// How many nodes an XPath finds.
int count(const Xml& xml, const char* path) {
  const std::unique_ptr<xmlXPathContext, decltype(&xmlXPathFreeContext)> context(xmlXPathNewContext(xml.get()),
                                                                                 &xmlXPathFreeContext);
  const std::unique_ptr<xmlXPathObject, decltype(&xmlXPathFreeObject)> found(
      xmlXPathEvalExpression(reinterpret_cast<const xmlChar*>(path), context.get()), &xmlXPathFreeObject);
  return found && found->nodesetval != nullptr ? found->nodesetval->nodeNr : 0;
}

TEST(ReportHtml, IsWellFormedWhateverTheWords) {
  const std::string html = document_html(make_document());
  const Xml xml = parse(html);
  ASSERT_NE(xml, nullptr) << html;
  EXPECT_EQ(count(xml, "/html/body/main/h1"), 1);
  EXPECT_EQ(count(xml, "//section/h2"), 1);
  EXPECT_THAT(html, HasSubstr("a&lt;b"));
  EXPECT_THAT(html, Not(HasSubstr("patient </style>"))) << "words in the style sheet do not end it";
}

TEST(ReportHtml, TellsThoseWhoDoNotSeeIt) {
  const Xml xml = parse(document_html(make_document()));
  ASSERT_NE(xml, nullptr);
  EXPECT_EQ(count(xml, "/html[@lang='en']"), 1);
  EXPECT_EQ(count(xml, "//p[@lang='de']"), 1);
  EXPECT_EQ(count(xml, "//img"), 2);
  EXPECT_EQ(count(xml, "//img[string-length(@alt) > 0]"), 2);
  EXPECT_EQ(count(xml, "//table[caption]"), 2);
  EXPECT_EQ(count(xml, "//th[@scope='col']"), 4);
  EXPECT_EQ(count(xml, "//th[@scope='row']"), 3);
  EXPECT_EQ(count(xml, "//th"), 7);
  EXPECT_EQ(count(xml, "//svg[@role='img'][@aria-label='movement [mm]: 0.0 \u2013 2.5']"), 1);
}

TEST(ReportHtml, SaysWhereEveryFigureComesFrom) {
  const Xml xml = parse(document_html(make_document()));
  ASSERT_NE(xml, nullptr);
  EXPECT_EQ(count(xml, "//data[@value='1.234'][@data-field='/volumes/0'][@data-unit='mL'][text()='1.23']"), 1);
  EXPECT_EQ(count(xml, "//data[@value='0.5'][@data-field='/share'][@data-unit='%'][text()='50']"), 1);
}

TEST(ReportHtml, HasThePaperAndTheNoticeOnEveryPage) {
  ReportDocument document = make_document();
  EXPECT_THAT(document_html(document), HasSubstr("size: A4;"));
  document.paper = Paper::kLetter;
  const std::string html = document_html(document);
  EXPECT_THAT(html, HasSubstr("size: letter;"));
  EXPECT_THAT(html, HasSubstr("content: \"page \" counter(page) \" of \" counter(pages) \"\""));
  EXPECT_THAT(html, HasSubstr("content: \"Not a \\22 device\\22 .\""));
  EXPECT_THAT(html, HasSubstr("<p class=\"notice\">Not a &quot;device&quot;.</p>"));
}

TEST(ReportCsv, HasEveryFigureUnroundedWithItsField) {
  EXPECT_EQ(document_csv(make_document()),
            "section,table,row,column,value,unit,field\n"
            "\"One & all\",\"Volumes\",\"a<b\",\"mL\",1.234,mL,/volumes/0\n"
            "\"One & all\",\"Volumes\",\"share\",\"mL\",50,%,/share\n");
}

TEST(ReportNumbers, AreWrittenAsTheLanguageHasThem) {
  EXPECT_EQ(number_text(1234.567, 2, Language::kEnglish), "1234.57");
  EXPECT_EQ(number_text(1234.567, 2, Language::kGerman), "1234,57");
  EXPECT_EQ(number_text(-0.5, 1, Language::kGerman), "\u22120,5");
  EXPECT_EQ(number_text(-0.001, 1, Language::kEnglish), "0.0") << "no minus before nothing";
  EXPECT_EQ(find_language("de"), Language::kGerman);
  EXPECT_EQ(find_language("fr"), std::nullopt);
}

}  // namespace
}  // namespace lipofill::client
