#include "export/robots/xml_text.h"

#include "tests/support/datasets.h"

#include <gtest/gtest.h>

namespace lorica {
namespace {

TEST(XmlText, EditedElementsKeepAllOtherBytes) {
  const std::string element = "<geom\n\tname = 'a>b'  mesh=\"m\" size='1'><plugin x=\"/>\"/></geom>";
  EXPECT_EQ(editedElement(element, {}), element);
  EXPECT_EQ(editedElement(element, {{"mesh", "n&'"}}),
            "<geom\n\tname = 'a>b'  mesh=\"n&amp;&apos;\" size='1'><plugin x=\"/>\"/></geom>");
  EXPECT_EQ(editedElement(element, {{"name", std::nullopt}, {"mass", "0"}, {"pos", std::nullopt}}),
            "<geom mass=\"0\"  mesh=\"m\" size='1'><plugin x=\"/>\"/></geom>");
  EXPECT_EQ(editedElement("<a/>", {{"b", "c"}}), "<a b=\"c\"/>");
}

TEST(XmlText, ReplacedElementsLeaveTheRestAsItIs) {
  const std::string before = "\xef\xbb\xbf<?xml version=\"1.0\"?>\r\n<a x='>'><!-- <b> --><![CDATA[<b>]]>\r\n\t";
  const std::string element = "<b y=\"/>\"><b><!-- </b> --></b ><c/></b>";
  const std::string after = "<c z='&#10;&lt;'/>\r\n</a>\r\n<!-- end -->";
  const test::TemporaryFolder folder;
  const auto file = folder.write("a.xml", before + element + after);
  XmlText xml = XmlText::read(file, "a.xml", NamedBy::kUser).value();
  const pugi::xml_node b = xml.root().child("b");
  EXPECT_EQ(xml.textOf(b), element);
  EXPECT_EQ(xml.where(b), "a.xml:3");
  EXPECT_EQ(xml.changedText(), before + element + after);
  xml.append(xml.root(), "<e/>");
  xml.replace(b, {"<d/>", "<d/>"});
  EXPECT_EQ(xml.changedText(), before + "<d/>\n\t<d/>" + "<c z='&#10;&lt;'/>\r\n<e/></a>\r\n<!-- end -->");
}

TEST(XmlText, EveryTruncatedPrefixIsRefused) {
  const std::string text = "<a x='1'><!-- c --><b y=\"2\">t</b><![CDATA[d]]></a>";
  const test::TemporaryFolder folder;
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto file = folder.write("a.xml", text.substr(0, size));
    EXPECT_FALSE(XmlText::read(file, "a.xml", NamedBy::kUser).ok()) << text.substr(0, size);
  }
}

TEST(XmlText, NumbersAreAllOrNone) {
  EXPECT_EQ(numbersOf("f:1", "pos", " 1\t-2e-3 \n+3 ", 3, 3).value(), (std::vector<double>{1.0, -2e-3, 3.0}));
  for (const char* bad : {"", "1 2", "1 2 3 4", "1 2 x", "1 2 3x", "1 2 nan", "1 2 1e999", "1,2,3"}) {
    const auto numbers = numbersOf("f:1", "pos", bad, 3, 3);
    ASSERT_FALSE(numbers.ok()) << bad;
    EXPECT_EQ(numbers.error().message, std::string("f:1: pos: found '") + bad + "', expected 3 numbers");
  }
}

}  // namespace
}  // namespace lorica
