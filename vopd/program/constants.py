"""The program's constants (A 19 to A 23, A 59, B 7, C 4, C 5), digit for digit."""

rad = 57.29577951  # degrees in a radian; DPR in TGTCAM, RD in ALPBET
dr = 0.0174532925  # radians in a degree, in ALPBET only
pi = 3.14159265  # for wrapping angles only
twopi = 2.0 * pi
ftpkm = 3280.8336  # feet in a kilometre
vftpkm = 0.0003048006  # kilometres in a foot, for the vehicle's X, Y, Z only: not quite 1 / ftpkm
factor = 0.713816400205  # millimetres on the film per inch on the reader; the scan has .7138154
eradkm = 6378.165  # radius of the Earth, kilometres
