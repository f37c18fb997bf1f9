# What README.md takes as given.
pcavr simulate push --no-images --seed 1 --duration 8 -o my_recording
mkdir my_recordings
cp -r my_recording my_recordings/first
