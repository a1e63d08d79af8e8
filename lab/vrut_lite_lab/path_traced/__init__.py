"""The GL frame against path-traced truth: truths kept on disk, their noise floor, table and sheet.

python -m vrut_lite_lab.path_traced.trace_truths     fill the folder of truths, hours of one core
python -m vrut_lite_lab.path_traced.table            table and sheet of the present frame, a minute
"""
