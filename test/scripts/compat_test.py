#!/usr/bin/python3
"""Parameter files of other localizers: compat of localize.launch, and translate_parameters."""
import subprocess
import sys

import roslib.packages
import rosunit
import yaml
from master_test_case import MAP, ROOT, MasterTest

FOREIGN = ROOT / "test/data/foreign"


def translate(*arguments):
    program = roslib.packages.find_node("racecar_mcl", "translate_parameters")[0]
    return subprocess.run([program, *map(str, arguments)], check=False, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                          universal_newlines=True)


class Compat(MasterTest):
    def testFilesOfOthersWorkUnchanged(self):
        for origin, file, expected in (("amcl", "amcl.yaml", "localizing from (-7.700 m, -2.750 m"),
                                       ("lab5", "lab5_params.yaml", "map_topic: remap map"),
                                       ("mit_pf", "mit_pf_flat.yaml", "viz: if there are subscribers")):
            with self.subTest(origin=origin):
                if file.endswith("_flat.yaml"):
                    nested = yaml.safe_load((FOREIGN / "mit_pf.yaml").read_text(encoding="utf-8"))
                    path = self.folder / file
                    path.write_text(yaml.dump(nested["particle_filter"]), encoding="utf-8")
                else:
                    path = FOREIGN / file
                text, names = self.launch(origin, "localize.launch", ["map of", expected], map=MAP, config=path,
                                          compat=origin)
                self.assertNotIn("not localizing", text)
                self.assertIn("localization/compat", names)

    def testWithoutCompatAllForeignNamesAreNamedAtOnce(self):
        text, _ = self.launch("without", "localize.launch", ["not localizing"], map=MAP, config=FOREIGN / "amcl.yaml")
        self.assertIn("'odom_alpha1'; that of amcl is 'expert/rotation_noise_from_rotation' here", text)
        self.assertIn("'base_frame_id'; that of amcl is 'particle_filter_frame' here", text)
        self.assertIn("'update_min_d'; that of amcl has no counterpart: every scan is used", text)

    def testTranslatedFilesAreConfigs(self):
        for file in ("amcl.yaml", "lab5_params.yaml", "mit_pf.yaml"):
            with self.subTest(file=file):
                result = translate(FOREIGN / file)
                self.assertEqual(result.returncode, 0, result.stderr)
                path = self.folder / file
                path.write_text(result.stdout, encoding="utf-8")
                text, _ = self.launch(file, "localize.launch", ["map of"], map=MAP, config=path)
                self.assertNotIn("not localizing", text)

    def testTranslationNamesWhatIsWrong(self):
        path = self.folder / "wrong.yaml"
        path.write_text("laser_model_type: sonar\n", encoding="utf-8")
        self.assertIn("laser_model_type is 'sonar'", translate(path).stderr)
        path.write_text("speed: 3\n", encoding="utf-8")
        self.assertIn("no parameter of amcl, lab5 or mit_pf", translate(path).stderr)
        self.assertIn("cannot be read", translate(self.folder / "none.yaml").stderr)
        self.assertIn("one of amcl lab5 mit_pf", translate(FOREIGN / "amcl.yaml", "--from", "nav2").stderr)


if __name__ == "__main__":
    rosunit.unitrun("racecar_mcl", "compat_test", Compat, sysargs=sys.argv)
