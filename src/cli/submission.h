#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace castray::cli {

/// A render in parts, and the merge of their films, as commands for an engine that runs them on many
/// machines.
struct Submission {
  std::string name;     ///< of the jobs: letters, digits and '-'
  std::string program;  ///< castray, as the machines find it
  std::string scene;
  std::vector<std::string> flags;        ///< of `castray render`, each a word
  std::vector<std::string> merge_flags;  ///< of `castray merge`, likewise
  std::vector<std::string> outputs;
  std::uint64_t parts = 1;
  std::uint64_t jobs = 1;         ///< at a time, on this machine
  std::string folder;             ///< of films and checkpoints; the machines share it
  std::string options;            ///< more words for the engine's own command
  std::string image, claim;       ///< Kubernetes: container image, PersistentVolumeClaim
  std::string queue, definition;  ///< AWS Batch: job queue, job definition
};

// Each is a shell script, or for Kubernetes a manifest for `kubectl apply -f -`. Lost and failed parts are
// tried again, and go on from their checkpoints; the merge depends on all parts.
std::string slurm_script(const Submission& s);
std::string kubernetes_manifest(const Submission& s);
std::string batch_script(const Submission& s);
std::string local_script(const Submission& s);

}  // namespace castray::cli
