"""Sensor models and the simulated drive shared by benchmark_live and benchmark_replay."""
from . import programs

MAP = programs.ROOT / "maps/corridor.yaml"
MODELS = {
    "likelihood_field": ["sensor_model:=likelihood_field"],
    "beam, simd": ["sensor_model:=beam", "range_method:=simd"],
    "beam, lut": ["sensor_model:=beam", "range_method:=lut"],
}


def particle_settings(particles):
    return [f"num_particles:={particles}", f"max_particles:={max(particles, 20000)}"]


def record_drive(bag, duration):
    """Simulates a drive at 3 m/s with scans of 1081 beams at 40 Hz and odometry at 50 Hz."""
    programs.run("simulate_bag", ["--map", MAP, "--out", bag, "--duration", duration, "--speed", 3])
