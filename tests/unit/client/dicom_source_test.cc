// Folders and zips of DICOM, and zips made to do harm.

#include "client/cpp/dicom/dicom_source.h"

#include <archive.h>
#include <archive_entry.h>
#include <gmock/gmock.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "dicom_fixture.h"

namespace lipofill::client {
namespace {

using ::testing::HasSubstr;

void write_zip(const std::filesystem::path& zip, const std::vector<std::pair<std::string, std::string>>& files,
               const char* password = nullptr) {
  archive* stream = archive_write_new();
  archive_write_set_format_zip(stream);
  if (password != nullptr) {
    archive_write_set_options(stream, "zip:encryption=aes256");
    archive_write_set_passphrase(stream, password);
  }
  ASSERT_EQ(archive_write_open_filename(stream, zip.c_str()), ARCHIVE_OK);
  for (const auto& [name, bytes] : files) {
    archive_entry* entry = archive_entry_new();
    archive_entry_set_pathname(entry, name.c_str());
    archive_entry_set_size(entry, static_cast<la_int64_t>(bytes.size()));
    archive_entry_set_filetype(entry, AE_IFREG);
    archive_entry_set_perm(entry, 0644);
    archive_write_header(stream, entry);
    archive_write_data(stream, bytes.data(), bytes.size());
    archive_entry_free(entry);
  }
  archive_write_close(stream);
  archive_write_free(stream);
}

class DicomSourceTest : public DicomTest {
 protected:
  TestSeries series_;
  std::vector<std::pair<std::string, std::string>> files_of_series() {
    series_.write(folder_ / "ct");
    std::vector<std::pair<std::string, std::string>> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "ct")) {
      std::ifstream stream(entry.path(), std::ios::binary);
      files.emplace_back("JANE SECRET/" + entry.path().filename().string(),
                         std::string((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>()));
    }
    return files;
  }
};

TEST_F(DicomSourceTest, AZipIsReadAsItsFolderIs) {
  auto files = files_of_series();
  files.emplace_back("../../outside.dcm", std::string(128, '\0') + "DICM and more");
  files.emplace_back("notes.txt", "no DICOM");
  write_zip(folder_ / "study.zip", files);
  expect_ball_in("study.zip");
  EXPECT_FALSE(std::filesystem::exists(folder_ / ".." / "outside.dcm"));
}

TEST_F(DicomSourceTest, TheUnpackedFilesGoWithTheSource) {
  write_zip(folder_ / "study.zip", files_of_series());
  std::filesystem::path unpacked;
  {
    const auto source = DicomSource::open(folder_ / "study.zip");
    ASSERT_TRUE(source.ok());
    ASSERT_EQ(source->files().size(), 32U);
    unpacked = source->files().front().parent_path();
    EXPECT_TRUE(std::filesystem::exists(unpacked));
  }
  EXPECT_FALSE(std::filesystem::exists(unpacked));
}

TEST_F(DicomSourceTest, RefusesABomb) {
  // 300 MB of nothing behind a preamble, in 300 KB.
  const std::string bomb = std::string(128, '\0') + "DICM" + std::string(size_t{300} << 20, '\0');
  write_zip(folder_ / "bomb.zip", {{"a.dcm", bomb}});
  EXPECT_THAT(dicom_refusal_of("bomb.zip"), HasSubstr("unpacks to more than the"));
  EXPECT_EQ(DicomSource::allowed_bytes(0), uint64_t{256} << 20);
  EXPECT_EQ(DicomSource::allowed_bytes(uint64_t{1} << 40), uint64_t{4} << 30);
}

TEST_F(DicomSourceTest, RefusesWhatItCannotUnpack) {
  write_zip(folder_ / "locked.zip", files_of_series(), "password");
  EXPECT_THAT(dicom_refusal_of("locked.zip"), HasSubstr("is encrypted: unpack it with its password"));
  write_zip(folder_ / "cut.zip", files_of_series());
  std::filesystem::resize_file(folder_ / "cut.zip", 9000);
  EXPECT_THAT(dicom_refusal_of("cut.zip"), HasSubstr("cut short"));
  write("empty.zip", "");
  EXPECT_THAT(dicom_refusal_of("empty.zip"), HasSubstr("empty.zip"));
  write_zip(folder_ / "none.zip", {{"notes.txt", "no DICOM"}});
  EXPECT_THAT(dicom_refusal_of("none.zip"), HasSubstr("holds no DICOM image"));
}

TEST_F(DicomSourceTest, KnowsDicomByItsName) {
  EXPECT_TRUE(DicomSource::is_dicom(folder_));
  EXPECT_TRUE(DicomSource::is_dicom("study.ZIP"));
  EXPECT_FALSE(DicomSource::is_dicom("head.mha"));
  series_.write_slice(0, folder_ / "IM0001");
  EXPECT_TRUE(DicomSource::is_dicom(folder_ / "IM0001"));
}

}  // namespace
}  // namespace lipofill::client
