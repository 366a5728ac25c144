#include <gtest/gtest.h>

#include <cmath>

#include "tools/score.hpp"

namespace flight_corridor::tools {
namespace {

const TruthRow kFreeTruth{{}, kInfinity, kInfinity, kInfinity};
const TruthRow kBlockedTruth{{}, 3.0, 3.0, 2.9};
const TruthRow kBorderlineTruth{{}, kInfinity, kInfinity, 3.9};

/// One recording, a frame every 0.1 s.
class Recording {
 public:
  Recording& add(TruthRow truth, State said, double clear_distance_m = kInfinity, double total_ms = 0.0) {
    truth.stamp = ros::Time(100, 100000000u * static_cast<unsigned>(truth_.size()));
    truth_.push_back(truth);
    ResultRow result;
    result.stamp = truth.stamp;
    result.state = said;
    result.clear_distance_m = clear_distance_m;
    result.times.total_ms = total_ms;
    results_.push_back(result);
    return *this;
  }

  Score score() const {
    Score score;
    addRecording(results_, truth_, score);
    return score;
  }

  std::vector<ResultRow> results_;
  std::vector<TruthRow> truth_;
};

TEST(Score, CountsEachAnswerAgainstTruth) {
  const Score score = Recording()
                          .add(kBlockedTruth, State::Blocked)
                          .add(kBlockedTruth, State::Free)
                          .add(kBlockedTruth, State::Unknown)
                          .add(kFreeTruth, State::Free)
                          .add(kFreeTruth, State::Blocked)
                          .add(kFreeTruth, State::Blocked)
                          .add(kFreeTruth, State::Unknown)
                          .score();
  EXPECT_EQ(score.blocked, 3);
  EXPECT_EQ(score.free, 4);
  EXPECT_EQ(score.false_free, 1);
  EXPECT_EQ(score.false_block, 2);
  EXPECT_EQ(score.unknown_of_blocked, 1);
  EXPECT_EQ(score.unknown_of_free, 1);
}

TEST(Score, DoesNotScoreFramesWhereOnlyTheInflatedBoxIsHit) {
  const Score score = Recording()
                          .add(kBorderlineTruth, State::Free)
                          .add(kBorderlineTruth, State::Blocked)
                          .add(kFreeTruth, State::Free)
                          .score();
  EXPECT_EQ(score.borderline, 2);
  EXPECT_EQ(score.blocked, 0);
  EXPECT_EQ(score.free, 1);
  EXPECT_EQ(score.false_free + score.false_block, 0);
}

TEST(Score, MeasuresDistanceOnlyWhereBothSayBlockedAtADistance) {
  const Score score = Recording()
                          .add(kBlockedTruth, State::Blocked, 2.75)
                          .add(kBlockedTruth, State::Blocked, kInfinity)  // by the fused range alone
                          .add(kBlockedTruth, State::Unknown, 1.0)
                          .add(kFreeTruth, State::Blocked, 1.0)
                          .score();
  EXPECT_EQ(score.distance_errors_m, std::vector<double>{0.25});
}

TEST(Score, KeepsWhatEachAnswerCost) {
  const Score score = Recording()
                          .add(kFreeTruth, State::Free, kInfinity, 20.0)
                          .add(kBorderlineTruth, State::Free, kInfinity, 30.0)
                          .score();
  EXPECT_EQ(score.frame_times_ms, (std::vector<double>{20.0, 30.0}));
}

TEST(Score, TimesTheReactionToEachChangeOfTruth) {
  const Score score = Recording()
                          .add(kFreeTruth, State::Free)
                          .add(kBorderlineTruth, State::Free)
                          .add(kBlockedTruth, State::Free)
                          .add(kBlockedTruth, State::Unknown)
                          .add(kBlockedTruth, State::Blocked)
                          .add(kBlockedTruth, State::Free)  // a relapse is a false FREE, not a reaction
                          .add(kFreeTruth, State::Free)
                          .score();
  ASSERT_EQ(score.reactions.size(), 2u);
  EXPECT_EQ(score.reactions[0].truth, State::Blocked);
  EXPECT_EQ(score.reactions[0].stamp, ros::Time(100, 200000000));
  EXPECT_NEAR(score.reactions[0].delay_s, 0.2, 1e-9);
  EXPECT_EQ(score.reactions[0].delay_frames, 2);
  EXPECT_EQ(score.reactions[1].truth, State::Free);
  EXPECT_EQ(score.reactions[1].delay_s, 0.0);
}

TEST(Score, StopsAtAnyVerdictButFreeAndHoldsFromThenOn) {
  const Score score = Recording()
                          .add(kFreeTruth, State::Free)
                          .add(kBlockedTruth, State::Free)
                          .add(kBlockedTruth, State::Unknown)  // it stops after 0.1 s
                          .add(kBlockedTruth, State::Blocked)
                          .add(kBlockedTruth, State::Free)
                          .add(kBlockedTruth, State::Blocked)
                          .add(kFreeTruth, State::Free)
                          .add(kBlockedTruth, State::Free)  // it never does
                          .add(kFreeTruth, State::Free)
                          .score();
  ASSERT_EQ(score.stop_times_s.size(), 2u);
  EXPECT_NEAR(score.stop_times_s[0], 0.1, 1e-9);
  EXPECT_TRUE(std::isnan(score.stop_times_s[1]));
  EXPECT_EQ(score.to_hold, 3);
  EXPECT_EQ(score.held, 2);
}

TEST(Score, HasNoTimeToStopWithoutFreeSpaceBefore) {
  const Score score = Recording().add(kBlockedTruth, State::Blocked).add(kBlockedTruth, State::Blocked).score();
  EXPECT_TRUE(score.stop_times_s.empty());
  EXPECT_EQ(score.to_hold, 1);
  EXPECT_EQ(score.held, 1);
}

TEST(Score, SaysWhenTheVerdictNeverFollowed) {
  const Score score =
      Recording().add(kFreeTruth, State::Free).add(kBlockedTruth, State::Unknown).add(kFreeTruth, State::Free).score();
  ASSERT_EQ(score.reactions.size(), 2u);
  EXPECT_TRUE(std::isnan(score.reactions[0].delay_s));
  EXPECT_EQ(score.reactions[0].delay_frames, 1);
  EXPECT_EQ(score.reactions[1].delay_s, 0.0);
}

TEST(Score, StartsTheClockAnewForEachRecording) {
  Score score;
  const Recording free = Recording().add(kFreeTruth, State::Free),
                  blocked = Recording().add(kBlockedTruth, State::Free);
  addRecording(free.results_, free.truth_, score);
  addRecording(blocked.results_, blocked.truth_, score);
  EXPECT_EQ(score.free + score.blocked, 2);
  EXPECT_TRUE(score.reactions.empty());
}

TEST(Score, CountsRecordingsBesideFrames) {
  Score score;
  for (const State said : {State::Free, State::Blocked}) {
    const Recording two = Recording().add(kBlockedTruth, said).add(kBlockedTruth, said);
    addRecording(two.results_, two.truth_, score);
  }
  const Recording never = Recording().add(kFreeTruth, State::Free);
  addRecording(never.results_, never.truth_, score);
  EXPECT_EQ(score.recordings_blocked, 2);
  EXPECT_EQ(score.recordings_false_free, 1);
}

TEST(Score, CountsTruthWithoutAVerdict) {
  Recording recording = Recording().add(kFreeTruth, State::Free).add(kBlockedTruth, State::Blocked);
  recording.results_.pop_back();
  EXPECT_EQ(recording.score().unanswered, 1);
  EXPECT_EQ(recording.score().unanswered_blocked, 1);
  EXPECT_EQ(recording.score().blocked, 0);
}

TEST(FalseFreeComplaint, IsEmptyWhenEveryTrulyBlockedFrameWasNotCalledFree) {
  EXPECT_EQ(falseFreeComplaint(Recording().add(kBlockedTruth, State::Unknown).score()), "");
  EXPECT_EQ(falseFreeComplaint(Recording().add(kFreeTruth, State::Blocked).score()), "");
}

TEST(FalseFreeComplaint, CountsFalseFree) {
  const Score score = Recording().add(kBlockedTruth, State::Blocked).add(kBlockedTruth, State::Free).score();
  EXPECT_EQ(falseFreeComplaint(score), "truly blocked frames called FREE: 1");
}

TEST(FalseFreeComplaint, CountsTrulyBlockedFramesWithoutAVerdict) {
  Recording recording = Recording().add(kFreeTruth, State::Free).add(kBlockedTruth, State::Blocked);
  recording.results_.pop_back();
  EXPECT_EQ(falseFreeComplaint(recording.score()), "truly blocked frames without a verdict: 1");
}

TEST(FalseFreeComplaint, IsThereWhenNothingWasScored) {
  EXPECT_EQ(falseFreeComplaint(Recording().score()), "no frame could be scored");
  EXPECT_EQ(falseFreeComplaint(Recording().add(kBorderlineTruth, State::Free).score()), "no frame could be scored");
}

TEST(Score, RefusesResultsOfAnotherRecording) {
  Recording recording = Recording().add(kFreeTruth, State::Free);
  recording.results_[0].stamp = ros::Time(5, 0);
  EXPECT_THROW(recording.score(), std::runtime_error);
}

TEST(Summarise, TellsAppearanceFromDisappearance) {
  const Score score = Recording()
                          .add(kFreeTruth, State::Free)
                          .add(kBlockedTruth, State::Free)
                          .add(kBlockedTruth, State::Blocked)
                          .add(kFreeTruth, State::Blocked)
                          .add(kFreeTruth, State::Unknown)
                          .add(kFreeTruth, State::Free)
                          .add(kBlockedTruth, State::Blocked)
                          .add(kFreeTruth, State::Blocked)
                          .score();
  const ReactionSummary appearance = summarise(score.reactions, State::Blocked);
  EXPECT_EQ(appearance.changes, 2);
  EXPECT_EQ(appearance.missed, 0);
  EXPECT_NEAR(appearance.median_s, 0.05, 1e-9);
  EXPECT_NEAR(appearance.longest_s, 0.1, 1e-9);
  EXPECT_EQ(appearance.longest_frames, 1);
  const ReactionSummary disappearance = summarise(score.reactions, State::Free);
  EXPECT_EQ(disappearance.changes, 2);
  EXPECT_EQ(disappearance.missed, 1);
  EXPECT_NEAR(disappearance.longest_s, 0.2, 1e-9);
  EXPECT_EQ(disappearance.longest_frames, 2);
}

TEST(Summarise, HasNoDelayWithoutAChange) {
  const ReactionSummary summary = summarise({}, State::Blocked);
  EXPECT_EQ(summary.changes, 0);
  EXPECT_TRUE(std::isnan(summary.median_s));
  EXPECT_TRUE(std::isnan(summary.longest_s));
}

// Newcombe 1998, Statistics in Medicine 17, table I, method 3: 81/263, 15/148, 0/20 and 1/29.
TEST(WilsonInterval, AgreesWithPublishedExamples) {
  EXPECT_NEAR(wilsonInterval(81, 263).lower, 0.2553, 5e-5);
  EXPECT_NEAR(wilsonInterval(81, 263).upper, 0.3662, 5e-5);
  EXPECT_NEAR(wilsonInterval(15, 148).lower, 0.0624, 5e-5);
  EXPECT_NEAR(wilsonInterval(15, 148).upper, 0.1605, 5e-5);
  EXPECT_NEAR(wilsonInterval(0, 20).upper, 0.1611, 5e-5);
  EXPECT_NEAR(wilsonInterval(1, 29).lower, 0.0061, 5e-5);
  EXPECT_NEAR(wilsonInterval(1, 29).upper, 0.1718, 5e-5);
}

TEST(WilsonInterval, NoneAndAllEndInClosedForms) {
  const double z2_over = 3.841459 / 103.841459;  // z^2 / (n + z^2) at n = 100
  EXPECT_NEAR(wilsonInterval(0, 100).lower, 0.0, 1e-12);
  EXPECT_NEAR(wilsonInterval(0, 100).upper, z2_over, 1e-6);
  EXPECT_NEAR(wilsonInterval(100, 100).lower, 1.0 - z2_over, 1e-6);
  EXPECT_NEAR(wilsonInterval(100, 100).upper, 1.0, 1e-12);
  EXPECT_TRUE(std::isnan(wilsonInterval(0, 0).lower));
  EXPECT_TRUE(std::isnan(wilsonInterval(0, 0).upper));
}

TEST(WilsonInterval, OfTheRestIsTheMirrorImage) {
  for (const int count : {1, 7, 40, 99}) {
    EXPECT_NEAR(wilsonInterval(count, 100).lower, 1.0 - wilsonInterval(100 - count, 100).upper, 1e-12) << count;
  }
}

TEST(Statistics, VarianceDividesByOneLessThanTheCount) {
  const SampleStatistics result = statistics({1.0, 2.0, 4.0, 5.0});
  EXPECT_EQ(result.count, 4u);
  EXPECT_EQ(result.mean_m, 3.0);
  EXPECT_NEAR(result.variance_m2, 10.0 / 3.0, 1e-12);
}

// Two samples a third: their means are 0, 6 and 0 around 2, so 2 * (4 + 16 + 4) of the squares lie between them and
// 6 * 1 within.
TEST(Statistics, TellsSlowMotionFromNoise) {
  EXPECT_NEAR(statistics({-1.0, 1.0, 5.0, 7.0, -1.0, 1.0}).slow_share, 48.0 / 54.0, 1e-12);
  EXPECT_EQ(statistics({-1.0, 1.0, 1.0, -1.0, -1.0, 1.0}).slow_share, 0.0);
}

TEST(Statistics, AConstantDoesNotMove) { EXPECT_EQ(statistics({2.0, 2.0, 2.0, 2.0}).slow_share, 0.0); }

TEST(Statistics, OneSampleHasNoVariance) { EXPECT_TRUE(std::isnan(statistics({1.0}).variance_m2)); }

TEST(Quantile, IsLinearBetweenValues) {
  EXPECT_EQ(quantile({3.0, 1.0, 2.0}, 0.5), 2.0);
  EXPECT_EQ(quantile({1.0, 2.0}, 0.5), 1.5);
  EXPECT_EQ(quantile({1.0, 2.0}, 1.0), 2.0);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

}  // namespace
}  // namespace flight_corridor::tools
