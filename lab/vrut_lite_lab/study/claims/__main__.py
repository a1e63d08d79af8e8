"""Print the measurements of the papers' claims."""

from vrut_lite_lab.study.claims import coefficients, look_ups, looks, resolution

for part in (coefficients, look_ups, resolution, looks):
    for text in part.report():
        print(text, flush=True)
