#include "collision/live/rigid_fit.h"

#include "tests/collision/parts.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace lorica {
namespace {

using test::uniform;
using test::uniformRotation;
using test::uniformVec3;

std::vector<Vec3> centered(std::vector<Vec3> points) {
  const Vec3 center = centroidOf(points);
  for (Vec3& p : points) p -= center;
  return points;
}

std::vector<Vec3> cloud(std::mt19937_64& random, int count, const Vec3& size) {
  std::vector<Vec3> points;
  points.reserve(count);
  for (int i = 0; i < count; ++i) points.push_back(uniformVec3(random, -1.0, 1.0).cwiseProduct(size));
  return centered(points);
}

std::vector<Vec3> moved(const std::vector<Vec3>& points, const Isometry3& motion) {
  std::vector<Vec3> result;
  result.reserve(points.size());
  for (const Vec3& p : points) result.push_back(motion * p);
  return result;
}

double squaredError(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const Isometry3& motion) {
  double sum = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (motion * from[i] - to[i]).squaredNorm();
  return sum;
}

Isometry3 motionOf(const Quat& rotation, const Vec3& translation) {
  return Eigen::Translation3d(translation) * rotation;
}

TEST(RigidFit, RecoversKnownMotions) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 300; ++i) {
    const std::vector<Vec3> points = cloud(random, 4 + i, uniformVec3(random, 0.01, 1.0));
    const Isometry3 truth = motionOf(uniformRotation(random), uniformVec3(random, -5.0, 5.0));
    const Isometry3 fit = fitRigidMotion(points, moved(points, truth), uniformRotation(random).toRotationMatrix());
    // The pull towards the previous rotation acts against the thinnest axis: (1 / 0.01)^2 * 1e-9.
    EXPECT_LT((fit.matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 2e-5) << "case " << i;
    EXPECT_LT(squaredError(points, moved(points, truth), fit), 1e-9) << "case " << i;
  }
}

TEST(RigidFit, RecoversHalfTurns) {
  std::mt19937_64 random(2);
  const std::vector<Vec3> points = cloud(random, 40, Vec3(0.3, 0.2, 0.1));
  for (const Vec3& axis : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1), Vec3(0.6, 0, 0.8)}) {
    const Isometry3 truth = motionOf(Quat(Eigen::AngleAxisd(std::numbers::pi, axis)), Vec3(1, 2, 3));
    const Isometry3 fit = fitRigidMotion(points, moved(points, truth), Mat3::Identity());
    EXPECT_LT((fit.matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 1e-7);
  }
}

TEST(RigidFit, FlatSetsHaveOneAnswer) {
  std::mt19937_64 random(3);
  const std::vector<Vec3> points = cloud(random, 30, Vec3(0.4, 0.3, 0.0));
  for (int i = 0; i < 100; ++i) {
    Quat rotation = uniformRotation(random);
    if (i == 0) rotation = Quat(Eigen::AngleAxisd(std::numbers::pi, Vec3::UnitX()));
    const Isometry3 truth = motionOf(rotation, uniformVec3(random, -1.0, 1.0));
    const Isometry3 fit = fitRigidMotion(points, moved(points, truth), Mat3::Identity());
    EXPECT_LT((fit.matrix() - truth.matrix()).cwiseAbs().maxCoeff(), 1e-7) << "case " << i;
    EXPECT_NEAR(fit.linear().determinant(), 1.0, 1e-12);
  }
}

TEST(RigidFit, MirroredPointsStillGiveTheBestProperRotation) {
  std::mt19937_64 random(4);
  const std::vector<Vec3> points = cloud(random, 50, Vec3(0.3, 0.25, 0.2));
  std::vector<Vec3> mirrored = points;
  for (Vec3& p : mirrored) p.y() = -p.y();
  const Isometry3 fit = fitRigidMotion(points, mirrored, Mat3::Identity());
  EXPECT_NEAR(fit.linear().determinant(), 1.0, 1e-12);
  const double best = squaredError(points, mirrored, fit);
  for (int i = 0; i < 20000; ++i) {
    EXPECT_GE(squaredError(points, mirrored, motionOf(uniformRotation(random), Vec3::Zero())), best - 1e-7);
  }
}

TEST(RigidFit, NoNearbyMotionFitsDeformedPointsBetter) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 20; ++i) {
    const std::vector<Vec3> points = cloud(random, 60, Vec3(0.3, 0.2, 0.1));
    std::vector<Vec3> deformed = moved(points, motionOf(uniformRotation(random), uniformVec3(random, -1.0, 1.0)));
    for (Vec3& p : deformed) p += uniformVec3(random, -0.05, 0.05);
    const Isometry3 fit = fitRigidMotion(points, deformed, Mat3::Identity());
    const double best = squaredError(points, deformed, fit);
    for (int k = 0; k < 500; ++k) {
      const double size = uniform(random, 1e-4, 0.1);
      const Quat turn(Eigen::AngleAxisd(size, uniformRotation(random) * Vec3::UnitX()));
      const Isometry3 other = motionOf(turn, uniformVec3(random, -size, size)) * fit;
      EXPECT_GE(squaredError(points, deformed, other), best - 1e-9);
    }
  }
}

TEST(RigidFit, PointsOnALineTurnNoMoreThanTheLineDoes) {
  std::vector<Vec3> line;
  for (int i = -5; i <= 5; ++i) line.emplace_back(0.0, 0.1 * i, 0.0);
  std::mt19937_64 random(6);
  for (int i = 0; i < 50; ++i) {
    const Quat previous = uniformRotation(random);
    const Quat turn(Eigen::AngleAxisd(uniform(random, 0.0, 2.5), uniformRotation(random) * Vec3::UnitX()));
    const Isometry3 truth = motionOf(turn * previous, Vec3(0.5, 1.0, 0.0));
    const Isometry3 fit = fitRigidMotion(line, moved(line, truth), previous.toRotationMatrix());
    EXPECT_LT(squaredError(line, moved(line, truth), fit), 1e-12);
    const Vec3 before = previous * Vec3::UnitY();
    const Vec3 after = turn * before;
    const double min = std::acos(std::clamp(before.dot(after), -1.0, 1.0));
    EXPECT_NEAR(Quat(fit.linear()).angularDistance(previous), min, 1e-6);
  }
}

TEST(RigidFit, PointsInOnePositionKeepTheRotation) {
  std::mt19937_64 random(7);
  const Quat previous = uniformRotation(random);
  const std::vector<Vec3> from(5, Vec3::Zero());
  const std::vector<Vec3> to(5, Vec3(1.0, 2.0, 3.0));
  const Isometry3 fit = fitRigidMotion(from, to, previous.toRotationMatrix());
  EXPECT_LT((fit.linear() - previous.toRotationMatrix()).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_LT((fit.translation() - Vec3(1.0, 2.0, 3.0)).norm(), 1e-12);
}

/// The best proper rotation for a covariance by definition (Kabsch), without a previous one.
Mat3 bestRotation(const Mat3& covariance) {
  const Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Mat3 flip = Mat3::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return svd.matrixU() * flip * svd.matrixV().transpose();
}

double angleBetween(const Mat3& a, const Mat3& b) {
  return Eigen::AngleAxisd(Mat3(a.transpose() * b)).angle();
}

double offOrthonormal(const Mat3& r) {
  return (r.transpose() * r - Mat3::Identity()).cwiseAbs().maxCoeff() + std::abs(r.determinant() - 1.0);
}

/// A covariance with given singular values; a negative last one means mirroring.
Mat3 covarianceWith(std::mt19937_64& random, const Vec3& values) {
  return uniformRotation(random).toRotationMatrix() * values.asDiagonal() *
         uniformRotation(random).toRotationMatrix().transpose();
}

/// Compares the fit with the truth for random covariances of one kind, and with previous rotations nearby, arbitrary,
/// opposite and drifted.
void expectTruth(std::uint64_t seed, const Vec3& low, const Vec3& high) {
  std::mt19937_64 random(seed);
  for (int i = 0; i < 3000; ++i) {
    Vec3 values;
    for (int k = 0; k < 3; ++k) values[k] = uniform(random, low[k], high[k]);
    const double scale = std::pow(10.0, uniform(random, -8.0, 4.0));
    const Mat3 covariance = covarianceWith(random, scale * values);
    const Mat3 truth = bestRotation(covariance);
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    const double turns[] = {uniform(random, 0.0, 0.1), uniform(random, 0.0, 3.0), std::numbers::pi};
    Mat3 previous = truth * Eigen::AngleAxisd(turns[i % 3], axis).toRotationMatrix();
    if (i % 2 == 0) {
      for (int k = 0; k < 3; ++k) previous.col(k) += uniformVec3(random, -1e-9, 1e-9);
    }
    const Mat3 fit = fitRotation(covariance, previous);
    EXPECT_LT(offOrthonormal(fit), 1e-12) << "case " << i;

    // How well the covariance determines the rotation about an axis is the sum of the two values across it. The pull,
    // if there is one, is 1e-9 of the norm.
    const Eigen::JacobiSVD<Mat3> svd(covariance);
    const Vec3& sizes = svd.singularValues();
    const double weakest = sizes[1] + (covariance.determinant() < 0.0 ? -sizes[2] : sizes[2]);
    EXPECT_LT(angleBetween(fit, truth), 3e-9 * covariance.norm() / weakest + 1e-7) << "case " << i;
    EXPECT_GE((fit.transpose() * covariance).trace(),
              (truth.transpose() * covariance).trace() - 1e-8 * covariance.norm())
        << "case " << i;
  }
}

TEST(RigidFit, RotationsAreTheBestForRoundedBodies) {
  expectTruth(11, Vec3(0.3, 0.3, 0.3), Vec3(1.0, 1.0, 1.0));
}

TEST(RigidFit, RotationsAreTheBestForElongatedBodies) {
  // A limb 1 : 1000 in point extents; the covariance has the squares.
  expectTruth(12, Vec3(0.5, 0.5e-6, 0.5e-6), Vec3(1.0, 1.5e-6, 1.5e-6));
  expectTruth(13, Vec3(0.5, 0.5e-3, 0.5e-3), Vec3(1.0, 1.5e-3, 1.5e-3));
  expectTruth(14, Vec3(0.5, 0.005, 0.005), Vec3(1.0, 0.03, 0.03));  // about where the fast method starts to apply
}

TEST(RigidFit, RotationsAreTheBestForNearlyFlatBodies) {
  expectTruth(15, Vec3(0.5, 0.3, 1e-12), Vec3(1.0, 0.9, 1e-9));
  expectTruth(16, Vec3(0.5, 0.3, 1e-6), Vec3(1.0, 0.9, 1e-3));
}

TEST(RigidFit, RotationsAreTheBestForMirroredBodies) {
  expectTruth(17, Vec3(0.7, 0.5, -0.3), Vec3(1.0, 0.7, -0.01));
}

TEST(RigidFit, AHundredThousandFramesDoNotDrift) {
  std::mt19937_64 random(18);
  const Mat3 shape = Vec3(1.0, 0.6, 0.3).asDiagonal();
  Mat3 truth = Mat3::Identity();
  Mat3 fit = truth;
  double worstDrift = 0.0;
  double worstAngle = 0.0;
  for (int i = 0; i < 100000; ++i) {
    const Vec3 axis = uniformRotation(random) * Vec3::UnitX();
    truth = Eigen::AngleAxisd(uniform(random, 0.0, 0.2), axis) * truth;
    if (i % 100 == 0) truth = Quat(truth).normalized().toRotationMatrix();
    fit = fitRotation(truth * shape, fit);
    worstDrift = std::max(worstDrift, offOrthonormal(fit));
    worstAngle = std::max(worstAngle, (fit - truth).norm());
  }
  EXPECT_LT(worstDrift, 1e-12);
  EXPECT_LT(worstAngle, 1e-10);
}

TEST(RigidFit, ManyAtOnceAreTheSameAsEachAloneOnEveryInstructionSet) {
  std::mt19937_64 random(19);
  for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 16u, 33u}) {
    std::vector<Mat3> covariances;
    std::vector<Mat3> previous;
    for (std::size_t i = 0; i < count; ++i) {
      // Every fifth is flat and every seventh mirrored: they take another code path.
      const Vec3 values(1.0, 0.6, i % 5 == 4 ? 1e-9 : i % 7 == 6 ? -0.3 : 0.4);
      covariances.push_back(covarianceWith(random, values));
      const Quat off(Eigen::AngleAxisd(uniform(random, 0.0, 0.5), uniformRotation(random) * Vec3::UnitX()));
      previous.emplace_back(bestRotation(covariances.back()) * off);
    }
    std::vector<Mat3> alone;
    for (std::size_t i = 0; i < count; ++i) alone.push_back(fitRotation(covariances[i], previous[i]));
    test::onEveryInstructionSet([&] {
      std::vector<Mat3> rotations = previous;
      fitRotations(covariances, rotations);
      for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(rotations[i], alone[i]) << i << " of " << count;
    });
  }
}

}  // namespace
}  // namespace lorica
