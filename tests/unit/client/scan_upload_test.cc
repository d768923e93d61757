#include "client/cpp/scan_upload.h"

#include <gmock/gmock.h>

#include "scripted_service.h"
#include "temporary_folder.h"

namespace lipofill::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

using ScanUploadTest = TemporaryFolderTest;

TEST_F(ScanUploadTest, HashesAsFips180Says) {
  EXPECT_EQ(*sha256_of_file(write("abc", "abc")), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(*sha256_of_file(write("empty", "")), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST_F(ScanUploadTest, SendsPiecesAndGoesOnWhereAStreamBroke) {
  std::string bytes(2 * kUploadChunkBytes + 1234, '\0');
  for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<char>(i * 31);
  BreakingPatientService service;
  service.drop_after_bytes = 1;  // after the first piece
  const LocalServer server(&service);
  const auto scan = upload_scan(Connection(server.address()), "patients/p", write("a.stl", bytes), v1::METRE);
  ASSERT_TRUE(scan.ok()) << scan.status();
  EXPECT_TRUE(scan->complete());
  EXPECT_TRUE(service.received == bytes);
  EXPECT_THAT(service.chunk_sizes, ElementsAre(kUploadChunkBytes, kUploadChunkBytes, 1234u));
}

TEST_F(ScanUploadTest, NamesWhatItCannotSend) {
  const Connection nowhere("127.0.0.1:1");
  EXPECT_THAT(std::string(upload_scan(nowhere, "patients/p", folder_ / "none.obj", v1::METRE).status().message()),
              HasSubstr("does not exist"));
  EXPECT_THAT(std::string(upload_scan(nowhere, "patients/p", write("a.step", "x"), v1::METRE).status().message()),
              HasSubstr(".step"));
  EXPECT_EQ(*scan_format_of("A.PLY"), v1::PLY);
}

}  // namespace
}  // namespace lipofill::client
