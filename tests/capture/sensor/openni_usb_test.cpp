#include "capture/sensor/openni_usb.h"

#include "tests/support/datasets.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace lorica {
namespace {

namespace fs = std::filesystem;

/// A system's USB devices, simulated by folders and files.
class UsbTest : public testing::Test {
 protected:
  void plugIn(const std::string& port, const std::string& vendor, const std::string& product, int device) {
    const fs::path folder = root_.path() / "devices" / port;
    fs::create_directories(folder / (port + ":1.0"));
    std::ofstream(folder / "idVendor") << vendor << "\n";
    std::ofstream(folder / "idProduct") << product << "\n";
    std::ofstream(folder / "busnum") << "1\n";
    std::ofstream(folder / "devnum") << device << "\n";
  }
  void permit(int device) {
    const fs::path folder = root_.path() / "nodes" / "001";
    fs::create_directories(folder);
    std::ofstream(folder / std::to_string(1000 + device).substr(1)) << "x";
  }
  [[nodiscard]] std::vector<UsbDepthCamera> cameras() const {
    return usbDepthCameras(root_.path() / "devices", root_.path() / "nodes");
  }

  const test::TemporaryFolder root_;
};

TEST_F(UsbTest, KnownCamerasAreFoundAmongOtherDevices) {
  plugIn("1-2", "046d", "c52b", 2);  // a mouse
  plugIn("1-4", "1d27", "0601", 12);
  plugIn("1-3", "045e", "02ae", 4);
  permit(12);
  const std::vector<UsbDepthCamera> found = cameras();
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].name, "Kinect v1");
  EXPECT_FALSE(found[0].packaged);
  EXPECT_FALSE(found[0].permitted);
  EXPECT_EQ(found[0].node, root_.path() / "nodes/001/004");
  EXPECT_EQ(found[1].name, "Asus Xtion Pro Live");
  EXPECT_TRUE(found[1].packaged);
  EXPECT_TRUE(found[1].permitted);
}

TEST_F(UsbTest, EachReasonIsASentence) {
  const auto why = [this](bool userDrivers) {
    const std::vector<std::string> sentences = whyNoCamera(cameras(), userDrivers);
    return sentences.size() == 1 ? sentences[0] : "";
  };
  const auto says = [](const std::string& sentence, const std::string& words) {
    return sentence.find(words) != std::string::npos;
  };
  EXPECT_TRUE(says(why(false), "no known depth camera"));
  plugIn("1-3", "045e", "02ae", 4);
  EXPECT_TRUE(says(why(false), "no permission")) << why(false);
  permit(4);
  EXPECT_TRUE(says(why(false), "needs libFreenectDriver")) << why(false);
  EXPECT_TRUE(says(why(true), "did not open it")) << why(true);
  fs::create_directories(root_.path() / "drivers/gspca_kinect");
  fs::create_symlink(root_.path() / "drivers/gspca_kinect", root_.path() / "devices/1-3/1-3:1.0/driver");
  EXPECT_TRUE(says(why(true), "in use by the kernel driver gspca_kinect")) << why(true);
  EXPECT_TRUE(says(why(true), "Kinect v1 (045e:02ae)")) << why(true);
}

TEST_F(UsbTest, OfACameraWithoutADriverTheSenderIsNamed) {
  plugIn("1-3", "8086", "0b3a", 4);
  const std::vector<std::string> why = whyNoCamera(cameras(), false);
  ASSERT_EQ(why.size(), 1U);
  EXPECT_NE(why[0].find("RealSense D435i (8086:0b3a): OpenNI2 has no driver for it: let realsense.py"),
            std::string::npos)
      << why[0];
}

TEST_F(UsbTest, OddFilesAreNoHarm) {
  EXPECT_TRUE(cameras().empty()) << "no such folder";
  plugIn("1-1", "", "", 1);
  plugIn("1-2", "not hexadecimal", "02ae", 1);
  plugIn("1-3", "1d27", "0609", -7);
  EXPECT_EQ(cameras().size(), 1u);
  EXPECT_FALSE(cameras()[0].permitted);
}

}  // namespace
}  // namespace lorica
