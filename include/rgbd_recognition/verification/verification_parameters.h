#pragma once

#include "rgbd_recognition/core/parameters.h"

namespace recognition {

/// What decides whether a hypothesis is accepted.
enum class Decision {
  kPaper,      ///< eq. (17); conflicts are hypotheses with the same best segment S*
  kConfidence  ///< calibrated probability over all evidence; conflicts are hypotheses that explain the same pixels
};

/// Parameters of Sec. VI (Table III and ours). Defaults are ours; config/paper.yaml holds the paper's.
struct VerificationParameters {
  Decision decision = Decision::kConfidence;

  // Eq. (15)-(17)
  double epsilon_d = 0.012;      ///< metres, of eq. (15)
  double epsilon_d_noise = 3.0;  ///< multiples of the sensor's sigma(z) on top of epsilon_d; the paper's test has 0
  double epsilon_c = 15.0;       ///< CIELAB distance, of eq. (16)
  int w = 2;                     ///< depth pixels, half window of eq. (16)
  double w_c = 0.6;
  double theta_c = 0.4;
  int max_rounds = 4;

  // Before the test
  bool refine = true;
  int refine_iterations = 12;
  bool illumination_compensation = true;
  bool test_alternatives = true;
  bool exhaustive = false;  ///< tests every hypothesis in full: the reference that the gates are measured against
  int max_hypotheses = 150;
  int correspondence_proposals = 12;
  int resting_proposals = 12;

  // Decision::kConfidence
  double min_confidence = 0.5;
  int min_consensus = 4;
  double min_visible = 0.1;
  double max_free_space = 0.35;
  double max_overlap = 0.3;

  ParameterList list();
  void validate() const;
};

}  // namespace recognition
