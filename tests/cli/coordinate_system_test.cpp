#include "cli/coordinate_system.h"

#include <gtest/gtest.h>

namespace soapfilm {
namespace TEST_FILE {

using cli::CoordinateSystem;

void expect(std::string_view text, const std::string& name, const std::string& unit) {
  const CoordinateSystem found = cli::coordinate_system_of(text);
  EXPECT_EQ(found.name, name) << text;
  EXPECT_EQ(found.unit, unit) << text;
}

TEST(CoordinateSystem, UnitIsThatOfTheAxesAndNotOfWhatTheSystemIsMadeOf) {
  const std::string degrees =
      R"(GEOGCS["WGS 84",DATUM["WGS_1984",SPHEROID["WGS 84",6378137,298.25,AUTHORITY["EPSG","7"]]],)"
      R"(PRIMEM["Greenwich",0],UNIT["degree",0.0174]])";
  expect(degrees, "WGS 84", "degree");
  const std::string projected =
      R"(PROJCS["A / zone 32N",)" + degrees + R"(,PROJECTION["T"],UNIT["US survey foot",0.3],AXIS["X",EAST]])";
  expect(projected, "A / zone 32N", "US survey foot");
  expect(R"(COMPD_CS["A + height",)" + projected + R"(,VERT_CS["height",VERT_DATUM["d",2005],UNIT["metre",1]]])",
         "A + height", "US survey foot");
}

TEST(CoordinateSystem, SecondVersionOfTheTextNamesUnitsOfEachAxisOrOfAll) {
  const std::string base =
      R"(PROJCRS["ETRS89 / UTM zone 32N",BASEGEOGCRS["ETRS89",DATUM["d",ELLIPSOID["GRS 1980",6378137,298,)"
      R"(LENGTHUNIT["foot",1]]]],CONVERSION["UTM",METHOD["TM"],PARAMETER["k",0,ANGLEUNIT["degree",1]]],)"
      R"(CS[Cartesian,2],)";
  expect(base + R"-(AXIS["(E)",east,ORDER[1],LENGTHUNIT["metre",1]],AXIS["(N)",north,LENGTHUNIT["metre",1]]])-",
         "ETRS89 / UTM zone 32N", "metre");
  expect(base + "AXIS[\"(E)\",east], AXIS[\"(N)\",north],\n  LENGTHUNIT[\"metre\",1]]", "ETRS89 / UTM zone 32N",
         "metre");
}

TEST(CoordinateSystem, OtherTextsAreTheirOwnName) {
  expect("EPSG:25832", "EPSG:25832", "");
  expect("", "", "");
  expect("]]][[\"", "]]][[\"", "");
  expect("LOCAL_CS[\"site", "site", "");
}

}  // namespace TEST_FILE
}  // namespace soapfilm
