// Records: what is written is read back by DCMTK; the same result gives the same objects.

#include <dcmtk/config/osconfig.h>
#include <dcmtk/dcmseg/segdoc.h>
#include <dcmtk/dcmsr/dsrdoc.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstring>

#include "client/cpp/json_file.h"
#include "client/cpp/records/encapsulated.h"
#include "client/cpp/records/fat_segmentation.h"
#include "client/cpp/records/figures_report.h"
#include "client/cpp/records/pacs.h"
#include "client/cpp/records/record.h"
#include "client/cpp/records/record_uid.h"
#include "records_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

std::string text_in(DcmDataset* record, const DcmTagKey& tag) {
  OFString text;
  record->findAndGetOFString(tag, text);
  return text.c_str();
}

std::string document_of(DcmDataset* record) {
  const Uint8* bytes = nullptr;
  Uint32 size = 0;
  EXPECT_TRUE(record->findAndGetUint8Array(DCM_EncapsulatedDocument, bytes).good());
  EXPECT_TRUE(record->findAndGetUint32(DCM_EncapsulatedDocumentLength, size).good());
  return std::string(reinterpret_cast<const char*>(bytes), size);
}

TEST(RecordUid, FollowsFromTheContent) {
  // Computed by hand, with Python's hashlib and whole numbers.
  EXPECT_EQ(uid_of("series", "content"), "2.25.317036745456111394389666116539920993695");
  EXPECT_NE(uid_of("instance", "content"), uid_of("series", "content"));
  EXPECT_NE(uid_of("a", "bc"), uid_of("ab", "c"));
  EXPECT_LE(uid_of("series", "").size(), 64U);
}

TEST(RecordText, DecimalsFitDicomAndPlainTextHasNoBytesOfItsOwn) {
  for (const double value : {0.1, -1.0 / 3.0 * 1e-7, 123456.789012345, 1e300, 0.0}) {
    const std::string text = decimal_string(value);
    EXPECT_LE(text.size(), 16U) << text;
    EXPECT_NEAR(std::stod(text), value, 1e-8 * std::abs(value));
  }
  EXPECT_EQ(plain_text("Wange\\\xC3\xA4\n", 64), "Wange????");
  EXPECT_EQ(plain_text("long", 2), "lo");
}

TEST(PacsAddress, IsTitleHostAndPort) {
  const auto pacs = parse_pacs_address("ORTHANC@pacs.clinic:4242", "ME");
  ASSERT_TRUE(pacs.ok());
  EXPECT_EQ(pacs->title, "ORTHANC");
  EXPECT_EQ(pacs->host, "pacs.clinic");
  EXPECT_EQ(pacs->port, 4242);
  for (const char* const wrong : {"", "ORTHANC", "@host:1", "A@:1", "A@host", "A@host:0", "A@host:70000", "A@host:x",
                                  "SEVENTEENLETTERSX@host:1"}) {
    EXPECT_EQ(parse_pacs_address(wrong, "ME").status().code(), absl::StatusCode::kInvalidArgument) << wrong;
  }
  EXPECT_FALSE(parse_pacs_address("A@host:1", "").ok());
}

TEST_F(RecordsTest, ARecordBelongsToTheStudyAndToNothingElse) {
  const RecordStudy of = study();
  EXPECT_EQ(of.study_uid, series_.uid + ".0");
  EXPECT_EQ(of.frame_of_reference_uid, kFrame);
  auto skin = make_skin_record(of, plan());
  EXPECT_EQ(text_in(skin.get(), DCM_PatientName), "JANE^SECRET");
  EXPECT_EQ(text_in(skin.get(), DCM_PatientID), "4711");
  EXPECT_EQ(text_in(skin.get(), DCM_PatientBirthDate), "19700102");
  EXPECT_EQ(text_in(skin.get(), DCM_StudyDate), "20240304");
  EXPECT_EQ(text_in(skin.get(), DCM_StudyInstanceUID), series_.uid + ".0");
  EXPECT_NE(text_in(skin.get(), DCM_SeriesInstanceUID), series_.uid);
  EXPECT_EQ(text_in(skin.get(), DCM_FrameOfReferenceUID), kFrame);
  EXPECT_FALSE(skin->tagExists(DCM_SeriesDescription) && text_in(skin.get(), DCM_SeriesDescription) == "Head 1.5 mm");
}

TEST_F(RecordsTest, TheSameResultGivesTheSameBytes) {
  const FinishedPlan result = plan();
  const auto bytes_of_all = [&] {
    const RecordStudy of = study();
    std::string bytes;
    const auto add = [&](DcmDataset* record) {
      EXPECT_TRUE(write_record(folder_ / "record.dcm", record).ok());
      bytes += *read_text_file(folder_ / "record.dcm");
    };
    add(make_report_record(of, result, "%PDF-1.4 odd")->get());
    add(make_skin_record(of, result).get());
    add(make_figures_record(of, result)->get());
    add(make_fat_record(of, result)->record.get());
    return bytes;
  };
  EXPECT_EQ(bytes_of_all(), bytes_of_all());
  auto other = make_report_record(study(), result, "%PDF-1.4 other");
  auto same = make_report_record(study(), result, "%PDF-1.4 odd");
  EXPECT_NE(text_in(other->get(), DCM_SOPInstanceUID), text_in(same->get(), DCM_SOPInstanceUID));
}

TEST_F(RecordsTest, DocumentsAreKeptByteForByte) {
  for (const std::string pdf : {"%PDF-1.4 odd", "%PDF-1.4 even"})
    EXPECT_EQ(document_of(make_report_record(study(), plan(), pdf)->get()), pdf);
  EXPECT_FALSE(make_report_record(study(), plan(), "no PDF").ok());
  const std::string stl = document_of(make_skin_record(study(), plan()).get());
  ASSERT_EQ(stl.size(), 80U + 4U + 2U * 50U);
  uint32_t count = 0;
  std::memcpy(&count, stl.data() + 80, 4);
  std::array<float, 12> first{};
  std::memcpy(first.data(), stl.data() + 84, sizeof first);
  EXPECT_EQ(count, 2U);
  EXPECT_THAT(first, ::testing::ElementsAre(0, 0, 1, 15.5, 24.125, 30.25, 25.5, 24.125, 30.25, 25.5, 34.125, 30.25));
}

TEST_F(RecordsTest, FiguresAreReadBackWithTheirUnits) {
  auto record = make_figures_record(study(), plan());
  ASSERT_TRUE(record.ok()) << record.status();
  DSRDocument document;
  ASSERT_TRUE(document.read(**record).good());
  EXPECT_EQ(document.getVerificationFlag(), DSRTypes::VF_Unverified);
  std::vector<std::string> figures;
  std::string group;
  DSRDocumentTree& tree = document.getTree();
  tree.gotoRoot();
  do {
    const DSRContentItem& item = tree.getCurrentContentItem();
    if (item.getConceptName().getCodeValue() == "112039") group = item.getStringValue().c_str();
    if (item.getValueType() != DSRTypes::VT_Num) continue;
    const DSRNumericMeasurementValue value = item.getNumericValue();
    EXPECT_EQ(value.getMeasurementUnit().getCodingSchemeDesignator(), "UCUM");
    figures.push_back(absl::StrFormat("%s: %s %s %s", group, item.getConceptName().getCodeValue().c_str(),
                                      value.getNumericValue().c_str(),
                                      value.getMeasurementUnit().getCodeValue().c_str()));
  } while (tree.iterate() != 0);
  EXPECT_THAT(figures, ::testing::ElementsAre("plan cheek: INJECTED 0.3 mL", "plan cheek: LIFT 2.5 mm",
                                              "plan cheek: MAXPRESSURE 812.5 Pa", "zone malar: 118565006 0.3 mL",
                                              "zone malar: MEANPRESSURE 700 Pa", "zone malar: THICKNESS 3 mm"));
}

TEST_F(RecordsTest, FatLiesOnTheVoxelsOfTheSeries) {
  auto fat = make_fat_record(study(), plan());
  ASSERT_TRUE(fat.ok()) << fat.status();
  // 10 x 10 x 3 mm whose faces are those of 10 x 8 x 2 voxels of 1 x 1.25 x 1.5 mm.
  EXPECT_NEAR(fat->film_ml, 0.3, 1e-9);
  EXPECT_NEAR(fat->voxels_ml, 0.3, 1e-9);
  DcmSegmentation* read = nullptr;
  ASSERT_TRUE(DcmSegmentation::loadDataset(*fat->record, read).good());
  const std::unique_ptr<DcmSegmentation> segmentation(read);
  ASSERT_EQ(segmentation->getNumberOfFrames(), fat->frames);
  EXPECT_EQ(segmentation->getNumberOfSegments(), 1U);
  EXPECT_EQ(text_in(fat->record.get(), DCM_FrameOfReferenceUID), kFrame);
}

TEST_F(RecordsTest, APlanThatHasNotEndedIsRefused) {
  write_result(folder_ / "running", "RUNNING");
  const auto running = read_finished_plan(folder_ / "running");
  EXPECT_EQ(running.status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(running.status().message()), HasSubstr("RUNNING"));
  EXPECT_EQ(read_finished_plan(folder_ / "none").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(RecordsTest, AStudyWithoutAVolumeTakesEverythingButTheFat) {
  series_.write_slice(0, folder_ / "one.dcm");
  const auto of = read_record_study(folder_ / "one.dcm", "");
  ASSERT_TRUE(of.ok()) << of.status();
  EXPECT_EQ(of->study_uid, series_.uid + ".0");
  EXPECT_EQ(make_fat_record(*of, plan()).status().code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_TRUE(make_figures_record(*of, plan()).ok());
  std::filesystem::create_directories(folder_ / "nothing");
  write("nothing/text", "no DICOM");
  EXPECT_FALSE(read_record_study(folder_ / "nothing", "").ok());
  EXPECT_THAT(std::string(read_record_study(folder_ / "ct", "9").status().message()), HasSubstr("there are 2 (CT"));
}

TEST_F(RecordsTest, TwoPatientsAreRefused) {
  series_.patient = "4712";
  series_.uid += "1";
  series_.write(folder_ / "ct" / "other");
  const auto both = read_record_study(folder_ / "ct", "");
  ASSERT_FALSE(both.ok());
  EXPECT_THAT(std::string(both.status().message()), HasSubstr("2 patients"));
}

}  // namespace
}  // namespace lipofill::client
