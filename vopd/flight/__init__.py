"""Attitude from today's files: a project file, picks in images, landmarks, a track and a lens."""
