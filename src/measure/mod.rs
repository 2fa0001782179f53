//! What is reported: measures of one frame and of a run.
