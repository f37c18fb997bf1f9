# What docs/tutorials/from-your-lab.md takes as given: the folder log/ of three programs.
pcavr simulate push --no-images --seed 12 -o recording
"$PCAVR_SOURCE"/tests/docs/write_lab_log.py recording box_1 log
