"""How many particles does a run need? Draws the figures of several seeds: python3 seeds.py seeds.png

    python3 seeds.py seeds.png demo.rawlog demo.truth.csv 5      # seeds 1 to 5
"""
import sys

import matplotlib  # type: ignore
matplotlib.use("Agg")  # a picture, no window
import matplotlib.pyplot as plt  # type: ignore
import numpy as np

import perception

picture, log, truth, seeds = sys.argv[1], sys.argv[2], sys.argv[3], int(sys.argv[4])
particles = [1, 2, 5, 10]
gospa = np.zeros((seeds, len(particles)))
for seed in range(seeds):
    for k, count in enumerate(particles):
        run = perception.track(log, "demo.ini", sensors="L", overrides={
            "run.seed": seed + 1, "run.association": "sampled", "particle_filter.sampleSize": count})
        report = perception.evaluate(run, truth, range=30)["runs"][0]
        gospa[seed, k] = report["set_distance"]["gospa_mean_m"]
mean, spread = gospa.mean(axis=0), gospa.std(axis=0)
plt.plot(particles, gospa.T, ".", color="gray")
plt.plot(particles, mean, "o-", label=f"mean of {seeds} seeds")
plt.fill_between(particles, mean - spread, mean + spread, alpha=0.2, label="standard deviation")
plt.xlabel("particles")
plt.ylabel("GOSPA [m], smaller is better")
plt.xscale("log")
plt.xticks(particles, [str(count) for count in particles])
plt.legend()
plt.savefig(picture, dpi=120)
print("particles", particles, "GOSPA", np.round(mean, 2), "+-", np.round(spread, 2))
