#include "cli/submission.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "cli/shell_word.h"

namespace castray::cli {

namespace {

using nlohmann::ordered_json;

/// How often a part that failed is tried anew.
constexpr int retries = 3;

std::string path(const Submission& s, const char* name) { return s.folder + "/" + name; }

/// `castray render` of one part.
std::vector<std::string> render_words(const Submission& s, const std::string& part) {
  std::vector<std::string> words{s.program, "render", s.scene};
  words.insert(words.end(), s.flags.begin(), s.flags.end());
  words.insert(words.end(), {"--part", part, "--checkpoint", path(s, "checkpoints/{part}.film"), "--resume",
                             "--progress", "lines", "-o", path(s, "{part}.film")});
  return words;
}

std::string shell_command(const std::vector<std::string>& words) {
  std::string command;
  for (const std::string& word : words) command += (command.empty() ? "" : " ") + shell_word(word);
  return command;
}

std::string render_command(const Submission& s) {
  return shell_command(render_words(s, fmt::format("auto/{}", s.parts)));
}

std::string merge_command(const Submission& s) {
  std::vector<std::string> words{s.program, "merge"};
  words.insert(words.end(), s.merge_flags.begin(), s.merge_flags.end());
  std::string command = shell_command(words) + " " + shell_word(s.folder) + "/*.film";
  for (const std::string& output : s.outputs) command += " -o " + shell_word(output);
  return command;
}

std::string make_folders(const Submission& s) { return "mkdir -p " + shell_word(path(s, "checkpoints")); }

std::string with_space(const std::string& options) { return options.empty() ? "" : " " + options; }

ordered_json kubernetes_job(const Submission& s, const std::string& name, ordered_json spec,
                            const ordered_json& command) {
  spec["template"]["spec"] = {
      {"restartPolicy", "OnFailure"},
      {"containers",
       {{{"name", "castray"},
         {"image", s.image},
         {"workingDir", "/work"},
         {"command", command},
         {"volumeMounts", {{{"name", "work"}, {"mountPath", "/work"}}}}}}},
      {"volumes", {{{"name", "work"}, {"persistentVolumeClaim", {{"claimName", s.claim}}}}}}};
  return {{"apiVersion", "batch/v1"}, {"kind", "Job"}, {"metadata", {{"name", name}}}, {"spec", spec}};
}

std::string batch_overrides(const ordered_json& command) {
  return shell_word(ordered_json{{"command", command}}.dump());
}

}  // namespace

std::string slurm_script(const Submission& s) {
  const std::string logs = shell_word(s.folder + "/%a.log"), merge_log = shell_word(s.folder + "/merge.log");
  const std::string options = with_space(s.options);
  return fmt::format(R"(#!/bin/sh
set -e
{folders}
# Slurm queues the parts of a lost machine again; a part that failed queues itself again, {retries} times.
array=$(sbatch --parsable --job-name={name} --array=0-{last} --requeue --open-mode=append --output={logs}{options} <<'END'
#!/bin/sh
{render} && exit
code=$?
if [ "${{SLURM_RESTART_COUNT:-0}}" -lt {retries} ]; then
  scontrol requeue "${{SLURM_ARRAY_JOB_ID}}_${{SLURM_ARRAY_TASK_ID}}" && sleep 60
fi
exit $code
END
)
sbatch --parsable --job-name={name}-merge --dependency=afterok:$array --kill-on-invalid-dep=yes --output={merge_log}{options} <<'END'
#!/bin/sh
{merge}
END
)",
                     fmt::arg("folders", make_folders(s)), fmt::arg("retries", retries),
                     fmt::arg("name", s.name), fmt::arg("last", s.parts - 1), fmt::arg("logs", logs),
                     fmt::arg("options", options), fmt::arg("render", render_command(s)),
                     fmt::arg("merge_log", merge_log), fmt::arg("merge", merge_command(s)));
}

std::string kubernetes_manifest(const Submission& s) {
  // The merge fails as long as films are missing.
  const ordered_json render = kubernetes_job(s, s.name,
                                             {{"completions", s.parts},
                                              {"parallelism", s.parts},
                                              {"completionMode", "Indexed"},
                                              {"backoffLimit", retries * s.parts}},
                                             {"sh", "-c", make_folders(s) + " && exec " + render_command(s)}),
                     merge = kubernetes_job(
                         s, s.name + "-merge", {{"completions", 1}},
                         {"sh", "-c",
                          fmt::format("until [ \"$(ls {}/*.film | wc -l)\" -eq {} ] && {}; do sleep 10; done",
                                      shell_word(s.folder), s.parts, merge_command(s))});
  return ordered_json{{"apiVersion", "v1"}, {"kind", "List"}, {"items", {render, merge}}}.dump(2) + "\n";
}

std::string batch_script(const Submission& s) {
  const std::string submit =
      fmt::format("aws batch submit-job --job-queue {} --job-definition {}{}", shell_word(s.queue),
                  shell_word(s.definition), with_space(s.options));
  return fmt::format(
      R"(#!/bin/sh
set -e
array=$({submit} --job-name {name} --array-properties size={parts} --retry-strategy attempts={attempts} \
  --query jobId --output text --container-overrides {render})
{submit} --job-name {name}-merge --depends-on jobId="$array" --container-overrides {merge}
)",
      fmt::arg("submit", submit), fmt::arg("name", s.name), fmt::arg("parts", s.parts),
      fmt::arg("attempts", retries + 1),
      fmt::arg("render", batch_overrides({"sh", "-c", make_folders(s) + " && exec " + render_command(s)})),
      fmt::arg("merge", batch_overrides({"sh", "-c", merge_command(s)})));
}

std::string local_script(const Submission& s) {
  // xargs gives the shell the part as $0.
  std::string render = shell_command(render_words(s, "PART"));
  const std::string place = "--part PART";
  render.replace(render.find(place), place.size(), fmt::format("--part \"$0/{}\"", s.parts));
  const std::string tries =
      fmt::format("for try in $(seq 0 {}); do {} && exit; done; exit 1", retries, render);
  return fmt::format(R"(#!/bin/sh
set -e
{}
seq 0 {} | xargs -n 1 -P {} sh -c {}
{}
)",
                     make_folders(s), s.parts - 1, s.jobs, shell_word(tries), merge_command(s));
}

}  // namespace castray::cli
