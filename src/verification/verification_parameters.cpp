#include "rgbd_recognition/verification/verification_parameters.h"

namespace recognition {

ParameterList VerificationParameters::list() {
  return {
      choiceParameter(
          "decision", &decision, {"paper", "confidence"},
          "paper: eq. (17) alone, conflicts by the best segment; confidence: calibrated, conflicts by pixels"),
      doubleParameter("epsilon_d", "m", &epsilon_d, 0.0, 0.2, "largest range difference that is consistent, eq. (15)"),
      doubleParameter("epsilon_d_noise", "", &epsilon_d_noise, 0.0, 10.0,
                      "added to epsilon_d: so many standard deviations of the sensor's noise at that depth"),
      doubleParameter("epsilon_c", "", &epsilon_c, 0.0, 200.0, "largest CIELAB distance that is consistent, eq. (16)"),
      intParameter("w", "px", &w, 0, 20, "half size of the window searched for a consistent colour, eq. (16)"),
      doubleParameter("w_c", "", &w_c, 0.0, 1.0, "weight of colour against depth consistency, eq. (17)"),
      doubleParameter("theta_c", "", &theta_c, 0.0, 1.0, "lowest total consistency, eq. (17); for decision paper"),
      choiceParameter("further_rounds", &further_rounds, {"acceptance", "candidates"},
                      "half of theta_c in further rounds: acceptance: eq. (17) is tested against it; candidates: it "
                      "only chooses what is looked for again; for decision paper"),
      intParameter("max_rounds", "", &max_rounds, 1, 20,
                   "rounds of matching and verification on what is left of a frame"),
      boolParameter("refine", &refine, "refine poses on depth, features and lightness before the test"),
      intParameter("refine_iterations", "", &refine_iterations, 1, 100, "most iterations of the refinement"),
      boolParameter("illumination_compensation", &illumination_compensation,
                    "fit the frame's illumination (colour transform of the model) before colours are compared"),
      boolParameter("test_alternatives", &test_alternatives,
                    "also test poses of the same shape (rotated can, flipped box); for decision confidence"),
      boolParameter("exhaustive", &exhaustive,
                    "test every hypothesis in full, however hopeless: slow, the reference for the gates"),
      intParameter("max_hypotheses", "", &max_hypotheses, 1, 100000,
                   "hypotheses tested in a round, those of the largest consensus first"),
      intParameter("correspondence_proposals", "", &correspondence_proposals, 0, 1000,
                   "poses that single correspondences propose, tested in the first round where nothing is found yet; "
                   "for decision confidence"),
      intParameter("resting_proposals", "", &resting_proposals, 0, 1000,
                   "poses that surfaces of the scene propose for objects that rest on a plane, tested after those; for "
                   "decision confidence"),
      doubleParameter("min_confidence", "", &min_confidence, 0.0, 1.0, "lowest confidence that is accepted"),
      intParameter("min_consensus", "", &min_consensus, 0, 1000,
                   "fewest different scene features that agree with the refined pose; for decision confidence"),
      doubleParameter("min_visible", "", &min_visible, 0.0, 1.0,
                      "smallest share of the projected model that must be seen; for decision confidence"),
      doubleParameter("max_free_space", "", &max_free_space, 0.0, 1.0,
                      "largest share of the projected model that the scene is seen through; for decision confidence"),
      doubleParameter("max_overlap", "", &max_overlap, 0.0, 1.0,
                      "largest share of its pixels that a detection may have in common with better ones"),
  };
}

void VerificationParameters::validate() const {
  VerificationParameters copy = *this;
  validateParameters(copy.list(), "reprojection_verification");
}

}  // namespace recognition
