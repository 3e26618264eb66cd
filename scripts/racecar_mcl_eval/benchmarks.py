"""What the benchmarks of whole processes share: the models they compare, and the drive."""
from . import programs

MAP = programs.ROOT / "maps/corridor.yaml"
MODELS = {
    "likelihood_field": ["sensor_model:=likelihood_field"],
    "beam, simd": ["sensor_model:=beam", "range_method:=simd"],
    "beam, panorama": ["sensor_model:=beam", "range_method:=panorama"],
}


def particle_settings(particles):
    return [f"num_particles:={particles}", f"global_particles:={max(particles, 20000)}"]


def record_drive(bag, duration):
    """Simulates a drive at 3 m/s: 40 scans of 1081 beams a second, 50 odometry messages a second."""
    programs.run("simulate_bag", ["--map", MAP, "--out", bag, "--duration", duration, "--speed", 3])
