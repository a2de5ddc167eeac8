#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <memory>
#include <set>

#include "castray/error.h"
#include "cli/commands.h"
#include "cli/process.h"
#include "cli/render_command.h"
#include "cli/shell_word.h"
#include "cli/submission.h"

namespace castray::cli {

namespace {

namespace fs = std::filesystem;

struct Submit {
  std::string engine;
  RenderCommand render;
  Submission submission;
  bool run_it = false;

  int run(const CommonFlags& common) {
    prepare(common);
    const std::string script = text();
    if (!run_it) {
      fmt::print("{}", script);
      return 0;
    }
    if (engine == "kubernetes") return run_script("kubectl apply -f - <<'END'\n" + script + "END\n");
    return run_script(script);
  }

 private:
  /// Fills in the submission. Throws InputError where a part could not be rendered.
  void prepare(const CommonFlags& common) {
    Submission& s = submission;
    for (const char* flag :
         {"part", "checkpoint", "resume", "stats", "progress", "preview-every", "preview", "tev", "samples"})
      if (is_given(flag, render.given))
        throw InputError(fmt::format("--{}: cannot go with submit, which decides it", flag));
    const Scene scene = load_scene(render.scene);
    const RenderRequest request = request_of(render, common, scene);
    for (const fs::path& output : request.outputs) check_output_image(output), s.outputs.push_back(output);
    if (s.parts < 1) throw InputError("--parts: must be at least 1");
    if (s.jobs < 1) throw InputError("--jobs: must be at least 1");
    range_of({0, s.parts}, {0, request.options.spp});
    s.scene = render.scene;
    s.name = job_name(scene.name);
    if (s.folder.empty()) s.folder = scene.name + ".parts";
    const bool in_container = engine == "kubernetes" || engine == "batch";
    s.program = in_container ? "castray" : fs::read_symlink("/proc/self/exe").string();
    static const std::set<std::string> of_images = {"exposure", "tone", "bits"};
    for (const GivenFlag& given : render.given) {
      auto& flags = of_images.contains(given.flag->name) ? s.merge_flags : s.flags;
      flags.push_back(std::string("--") + given.flag->name);
      if (given.flag->metavar) flags.push_back(given.value);
    }
  }

  std::string text() const {
    if (engine == "slurm") return slurm_script(submission);
    if (engine == "local") return local_script(submission);
    if (engine == "kubernetes") {
      demand("image", submission.image);
      demand("claim", submission.claim);
      return kubernetes_manifest(submission);
    }
    demand("queue", submission.queue);
    demand("definition", submission.definition);
    return batch_script(submission);
  }

  void demand(const char* flag, const std::string& value) const {
    if (value.empty()) throw InputError(fmt::format("submit {}: needs --{}", engine, flag));
  }

  /// What Kubernetes takes for a name, as the others do.
  static std::string job_name(std::string name) {
    for (char& c : name)
      c = std::isalnum(static_cast<unsigned char>(c)) ? static_cast<char>(std::tolower(c)) : '-';
    return "castray-" + name.substr(0, 40);
  }

  static int run_script(const std::string& script) {
    std::fflush(stdout);
    return exit_code_of(std::system(("exec sh -c " + shell_word(script)).c_str()));
  }
};

}  // namespace

Run add_submit(Arguments& arguments, const CommonFlags& common) {
  auto submit = std::make_shared<Submit>();
  Submission& s = submit->submission;
  arguments.add_positional("ENGINE", submit->engine, "slurm, kubernetes, batch (of AWS) or local")
      .required()
      .one_of({"slurm", "kubernetes", "batch", "local"});
  declare_flags(arguments, submit->render);
  const auto add = [&](const char* name, auto& value, const char* metavar, const char* help) {
    arguments.add(name, value, metavar, help).group("Submitting");
  };
  add("--parts", s.parts, "N", "of the samples, each a job");
  arguments.add_switch("--run", submit->run_it, "submit, instead of printing what would").group("Submitting");
  add("--folder", s.folder, "DIR", "of films and checkpoints, which the machines share [SCENE.parts]");
  add("--options", s.options, "WORDS", "for sbatch or aws, as in '--partition=long --time=60'");
  add("--jobs", s.jobs, "N", "local: parts at a time [1]");
  add("--image", s.image, "IMAGE", "kubernetes: of the container, with castray in it");
  add("--claim", s.claim, "NAME", "kubernetes: PersistentVolumeClaim, mounted as /work");
  add("--queue", s.queue, "NAME", "batch: job queue");
  add("--definition", s.definition, "NAME", "batch: job definition");
  arguments.footer(
      "Prints a script (for kubernetes a manifest) of an array of parts and the merge that depends on it.");
  return [submit, &common] { return submit->run(common); };
}

}  // namespace castray::cli
