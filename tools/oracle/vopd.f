C     PROGRAM VOPD, NASA TM X-3050, APPENDIX B, REPAIRED AND ADAPTED FOR
C     GFORTRAN.  SEE README.MD OF THIS FOLDER FOR HOW TO COMPILE IT.
C     R1, M1, D1 IN COMMENTS ARE ROWS OF ITS TABLES - R REPAIR TO THE
C     SCAN, M ADAPTATION TO THE MACHINE, D DIFFERENCE FROM THE RESULTS
C     OF 1974.  COLUMNS 73-80 ARE THE CARD NUMBERS OF APPENDIX B.
C     M1 THE PROGRAM CARD HAS NO FILE LIST
      PROGRAM VOPD                                                      A   1
C     M2 ARRAY SIZES - FRAMES, LANDMARKS A FRAME, TABLE ROWS, LANDMARK
C     NUMBERS.  MID0 TO MID IS MORE THAN A BASIC DATA CARD CAN NAME.
      PARAMETER (MFR=20000, MLF=100, MTB=3000, MID0=-9, MID=999)
      PARAMETER (MSV=12+3*MLF, MIG=1000)
C     R1 DRR(20) IN THE NEXT STATEMENT
      DIMENSION RRR(25), ISAVE(MSV), XSAVE(MSV), YSAVE(MSV), XRR(25),   A   2
     1RR(MLF), DRR(MLF), DXY(MLF)                                       A   3
      DIMENSION XLAM(MLF), XMU(MLF), XNU(MLF), B(2,6), BS(6,2), XN(6,6),A   4
     1EPS(2,MLF), C(6,1), XMM(MLF), XNN(MLF), QQ(MLF), NG(MLF), X(MLF), A   5
     2Y(MLF), SX(20), SY(20), IDENT(MLF), CM(MLF), CN(MLF), IPIVOT(6),  A   6
     3INDEX(6,2)
      DIMENSION PHIBD(100), PHIBM(100), PHIBS(100), XLOBD(100), XLOBM(10A   7
     10)                                                                A   8
      DIMENSION XLOBS(100), TXYZT(20,4), TGTTAB(MLF,3), XYZTAB(3),      A   9
     1XX(MLF), YY(MLF), XNTEMP(6,6), XNUNIT(6,6)                        A  10
      DIMENSION TTHJ(MID0:MID), TTHJMI(MID0:MID), TPHJ(MID0:MID),       A  11
     1TPHJMI(MID0:MID), TRJ(MID0:MID)
      DIMENSION GEODA(MLF,3), GEODB(MLF,3)                              A  12
      DIMENSION NPT(MFR), IFRM(MFR), TIMX(MFR), XXX(MTB), YYY(MTB),     A  13
     1ZZZ(MTB), XFRM(MFR)                                               A  14
      DIMENSION IOUT(MIG), IFM(MFR), JOUT(6,MFR)                        A  15
      COMMON /AB/ III,IWV,TX(MTB),VVX(MTB),VVY(MTB),VVZ(MTB),H(MTB),    A  16
     1ALT(MTB),VXO(MTB),VYO(MTB)                                        A  17
      COMMON /DIRCOS/ XLAM,XMU,XNU                                      A  18
      CHARACTER TITLE*80, LINE*132
C     R2 FACTOR.  M3 SLASHES FOR PARENTHESES
      DATA RAD/57.29577951/, PI/3.14159265/, FTPKM/3280.8336/, FACTOR/.7A  19
     113816400205/, ERADKM/6378.165/, V/0.0/                            A  20
      DATA SFOCAL/.0015/, SLAT/.0833333333333/, SXYZ/200./, SRJ/200./,  A  21
     1SXPYP/.01/, SXY/0.1/, VFTPKM/.0003048006/, RN/0./                 A  22
C     M4 WHAT THE LOADER OF 1974 LEFT ZERO
      DATA NG/MLF*0/
C     M5 UNITS
      CALL FILES
      TWOPI=(2.*PI)                                                     A  23
      ITGTO=1                                                           A  24
      DELFF=0.                                                          A  25
1     READ (5,76) (XRR(I),RRR(I),I=1,25)                                A  26
C     M6 TITLE IN A VARIABLE.  M7 END OF FILE
2     READ (5,77,END=13) TITLE                                          A  28
200   JUMP=0                                                            A  31
3     READ (5,78) III,IWV,S1M,S1A,S2M,S2A,S3M,S3A                       A  32
4     READ (5,79) (ALT(I),VXO(I),VYO(I),I=1,IWV)                        A  34
C     R3 NT FOR NI, NTFR FOR NFRX
5     READ (5,80) NT,NFR,NTFR,(NPT(L),L=1,NFR)                          A  36
C     R4 NTFR CARDS, NOT NFR
6     READ (5,81) (IFRM(I),TIMX(I),I=1,NTFR)                            A  38
C     R5 LOOP OF 700
      DO 700 JOT=1,NTFR                                                 A  40
700   XFRM(JOT)=IFRM(JOT)                                               A  41
7     READ (5,82) (TX(I),XXX(I),YYY(I),ZZZ(I),VVX(I),VVY(I),VVZ(I),H(I),A  42
     1I=1,III)                                                          A  43
8     READ (5,82) CC,PHI,THZ,RZ,ALPHAI,XOMEGI,XKAPI                     A  46
C     R6 LOST CARD, A 47 OR A 48
      RZ=RZ*1000./FTPKM
      PHITEM=PHI                                                        A  49
      TWOPHI=(2.*PHI)/RAD                                               A  50
      FORPHI=2.*TWOPHI                                                  A  51
      SIXPHI=3.*TWOPHI                                                  A  52
      SINTPD=SIN(TWOPHI)                                                A  53
      SINFPD=SIN(FORPHI)                                                A  54
      SINSPD=SIN(SIXPHI)                                                A  55
      PHI=PHI-.1932398611111*SINTPD+.0003258611111111*SINFPD+7.222222222A  56
     12E-07*SINSPD                                                      A  57
      PHIZ=PHI                                                          A  58
      DPR=57.29577951                                                   A  59
      PHIZ=PHIZ/DPR                                                     A  60
      THZ=THZ/DPR                                                       A  61
9     DO 1100 IJK=1,NT                                                  A  62
      READ (5,83) ITGT,THJ,THJMI,PHIJ,PHIJMI,RJ                         A  63
C     R7 THE STRAY CARD RJ=RJ*1000./FTPKM IS LEFT OUT
C     M8 NUMBERS OUTSIDE THE TABLE, WHICH NO BASIC DATA CARD CAN NAME
      IF (ITGT.LT.MID0.OR.ITGT.GT.MID) GO TO 1100
      TTHJ(ITGT)=THJ                                                    A  65
      TTHJMI(ITGT)=THJMI                                                A  66
      TPHJ(ITGT)=PHIJ                                                   A  67
      TPHJMI(ITGT)=PHIJMI                                               A  68
      TRJ(ITGT)=RJ
1100  CONTINUE
10    READ (5,80) NOUT                                                  A  71
      IF (NOUT.LT.1) GO TO 12                                           A  72
11    READ (5,84) (IFM(I),(JOUT(J,I),J=1,6),I=1,NOUT)                   A  73
      DO 130 I=1,NOUT                                                   A  74
      DO 130 J=1,6                                                      A  75
      IF (JOUT(J,I).LT.1) JOUT(J,I)=101                                 A  76
130   CONTINUE                                                          A  77
12    READ (5,80) NGO,(IOUT(I),I=1,NT)                                  A  79
      DO 15 LL=1,NT                                                     A  80
      IF (IOUT(LL).LT.1) IOUT(LL)=101                                   A  81
15    CONTINUE                                                          A  82
      IF (JUMP.GT.0) GO TO 20                                           A  84
C     R8 DO 19, NOT DO 13
      DO 19 N=1,NFR                                                     A  85
      IUP=NPT(N)*3+12                                                   A  86
      READ (5,86) (ISAVE(I),XSAVE(I),YSAVE(I),IFRAM,I=1,IUP)            A  87
      YPC=0.                                                            A  88
      XPC=0.                                                            A  89
      DO 16 I=1,12                                                      A  90
      XPC=XPC+XSAVE(I)/12.                                              A  91
16    YPC=YPC+YSAVE(I)/12.                                              A  92
      IUP=NPT(N)                                                        A  93
      II=12                                                             A  94
      DO 18 I=1,IUP                                                     A  95
      XSAVE(I)=0.                                                       A  96
      YSAVE(I)=0.                                                       A  97
      DO 17 J=1,3                                                       A  98
      II=II+1                                                           A  99
      XSAVE(I)=XSAVE(I)+XSAVE(II)/3.                                    A 100
17    YSAVE(I)=YSAVE(I)+YSAVE(II)/3.                                    A 101
18    ISAVE(I)=ISAVE(II)                                                A 102
C     R8 LOST CARD
19    WRITE (9,87) IFRAM,XPC,YPC,(ISAVE(I),XSAVE(I),YSAVE(I),I=1,IUP)   A 103
      JUMP=1                                                            A 104
20    REWIND 9                                                          A 105
C     R9 A 106 CANNOT BE READ, AND NOTHING NEEDS IT
      IFOCFG=1                                                          A 107
      KK=0                                                              A 108
      ALPHAP=ALPHAI                                                     A 109
      XOMEGP=XOMEGI                                                     A 110
      XKAPP=XKAPI                                                       A 111
21    KK=KK+1                                                           A 112
      IF (KK.LE.NFR) GO TO 22                                           A 113
      REWIND 9                                                          A 114
C     M9 END FILE 10 IS LEFT OUT                                        A 115
      WRITE (6,77) TITLE                                                A 117
      GO TO (1,2,3,4,5,6,7,8,9,10,11,12,13), NGO                        A 118
C     M10 NGO OUTSIDE 1 TO 13
      WRITE (0,'(A,I6)') ' NGO OUT OF RANGE',NGO
      STOP 1
22    NJ=NPT(KK)                                                        A 119
      READ (9,87) IFRAM,XPC,YPC                                         A 120
      XFRAM=IFRAM                                                       A 121
      CALL FTLUP (XFRAM,TI,1,NTFR,XFRM,TIMX)                            A 122
      CALL FTLUP (TI,XYZ,1,III,TX,XXX)                                  A 123
      XYZTAB(1)=XYZ                                                     A 124
      CALL FTLUP (TI,XYZ,1,III,TX,YYY)                                  A 125
      XYZTAB(2)=XYZ                                                     A 126
      CALL FTLUP (TI,XYZ,1,III,TX,ZZZ)                                  A 127
      XYZTAB(3)=XYZ                                                     A 128
      IF (NOUT.LT.1) GO TO 25                                           A 129
      DO 24 I=1,NOUT                                                    A 130
      IF (IFRAM.NE.IFM(I)) GO TO 24                                     A 131
      IF (JOUT(1,I).NE.100) GO TO 25                                    A 132
      DO 23 L=1,NJ                                                      A 133
23    READ (9,87) ITGT,XCO,YCO                                          A 134
      WRITE (6,88) IFRAM                                                A 135
      GO TO 21                                                          A 136
24    CONTINUE                                                          A 137
25    INJ=0                                                             A 138
      NK=0                                                              A 139
      WRITE (6,77) TITLE                                                A 140
      WRITE (6,89)                                                      A 141
      DO 31 JJ=1,NJ                                                     A 142
      READ (9,87) ITGT,XCO,YCO                                          A 143
      IF (NOUT.LT.1) GO TO 28                                           A 144
      DO 27 I=1,NOUT                                                    A 145
      IF (IFRAM.NE.IFM(I)) GO TO 27                                     A 146
      DO 26 M=1,6                                                       A 147
      IF (ITGT.NE.JOUT(M,I)) GO TO 26                                   A 148
      NK=NK+1                                                           A 149
      IF ((NJ-NK).LT.2) GO TO 28                                        A 150
      WRITE (6,90) ITGT                                                 A 151
      GO TO 31                                                          A 152
26    CONTINUE                                                          A 153
27    CONTINUE                                                          A 154
28    DO 29 I=1,NT                                                      A 155
      IF (IOUT(I).NE.ITGT) GO TO 29                                     A 156
      NK=NK+1                                                           A 157
      IF ((NJ-NK).LT.2) GO TO 30                                        A 158
      WRITE (6,90) ITGT                                                 A 159
      GO TO 31                                                          A 160
29    CONTINUE                                                          A 161
30    INJ=INJ+1                                                         A 162
      X(INJ)=XCO                                                        A 163
      Y(INJ)=YCO                                                        A 164
      THJ=TTHJ(ITGT)                                                    A 165
      THJMI=TTHJMI(ITGT)                                                A 166
      PHIJ=TPHJ(ITGT)                                                   A 167
      PHIJMI=TPHJMI(ITGT)                                               A 168
      RJ=TRJ(ITGT)                                                      A 169
      IDENT(INJ)=ITGT                                                   A 173
      THJ=THJ+THJMI/60.                                                 A 174
      GEODA(INJ,1)=THJ                                                  A 175
      THJ=THJ+RN*SLAT                                                   A 176
      GEODB(INJ,1)=THJ                                                  A 177
      PHIJ=PHIJ+PHIJMI/60.                                              A 178
      GEODA(INJ,2)=PHIJ                                                 A 179
      PHIJ=PHIJ+RN*SLAT                                                 A 180
      GEODB(INJ,2)=PHIJ                                                 A 181
      PHIJS1=PHIJ                                                       A 182
      GEODA(INJ,3)=RJ                                                   A 183
      RJ=RJ+RN*SRJ                                                      A 184
      GEODB(INJ,3)=RJ                                                   A 185
      RJ=RJ/FTPKM+ERADKM                                                A 186
      PHI=PHIJ                                                          A 187
      TWOPHI=(2.*PHI)/RAD                                               A 188
      FORPHI=2.*TWOPHI                                                  A 189
      SIXPHI=3.*TWOPHI                                                  A 190
      PHI=PHITEM                                                        A 191
      SINTPD=SIN(TWOPHI)                                                A 192
      SINFPD=SIN(FORPHI)                                                A 193
      SINSPD=SIN(SIXPHI)                                                A 194
C     ONE ZERO TOO MANY IN .0000325..., THE PROGRAM'S OWN SLIP
      PHIJ=PHIJ-.1932398611111*SINTPD+.0000325861111111*SINFPD+7.2222222A 195
     1222E-07*SINSPD                                                    A 196
      TGTTAB(INJ,1)=THJ                                                 A 197
      TGTTAB(INJ,2)=PHIJ                                                A 198
      TGTTAB(INJ,3)=RJ                                                  A 199
C     R10 RIGHT SIDE UNREADABLE AND NEVER USED
31    ITGTO=ITGT
      NJ=INJ                                                            A 201
      N=NJ                                                              A 202
      CCSAVE=0.                                                         A 204
32    IRUN=0
      RUNFLG=1.                                                         A 207
      IRUNCO=10                                                         A 208
      RNSXYZ=RN*SXYZ                                                    A 209
      XYZTAB(1)=XYZTAB(1)+RNSXYZ                                        A 210
      XYZTAB(2)=XYZTAB(2)+RNSXYZ                                        A 211
      XYZTAB(3)=XYZTAB(3)+RNSXYZ                                        A 212
      TXYZT(1,1)=TI                                                     A 213
      TXYZT(1,2)=XYZTAB(1)*VFTPKM                                       A 214
      TXYZT(1,3)=XYZTAB(2)*VFTPKM                                       A 215
      TXYZT(1,4)=XYZTAB(3)*VFTPKM                                       A 216
      CALL TGTCAM (1,NJ,RZ,PHIZ,THZ,TXYZT,TGTTAB)                       A 217
      DO 33 I=1,NJ                                                      A 218
C     R11 FTPKM IN THIS CARD AND IN 33
      TGTTAB(I,3)=TGTTAB(I,3)*FTPKM/1000.
C     M11 PRT BLANKS THE ZERO BEFORE THE POINT, HERE AND BELOW
      WRITE (LINE,91) IDENT(I),(TGTTAB(I,J),J=1,3),(GEODA(I,J),J=2,3),  A 219
     1XLAM(I),XMU(I),XNU(I)                                             A 220
      CALL PRT (LINE,LEN_TRIM(LINE))
33    TGTTAB(I,3)=TGTTAB(I,3)/FTPKM*1000.
      CCORIG=CC                                                         A 221
      CC=CC+RN*SFOCAL                                                   A 222
      CCLAST=CC                                                         A 223
      IF (CCSAVE.GT.0.) CC=CCSAVE                                       A 224
      CCI=CC                                                            A 225
      ALPSAV=ALPHAP                                                     A 226
      OMESAV=XOMEGP                                                     A 227
      XKASAV=XKAPP                                                      A 228
      WRITE (6,92)                                                      A 229
      WRITE (LINE,93) (XYZTAB(I),I=1,3),XPC,YPC,CC                      A 230
      CALL PRT (LINE,LEN_TRIM(LINE))
      XPC=XPC+RN*SXPYP                                                  A 231
      YPC=YPC+RN*SXPYP                                                  A 232
      XPC=XPC*FACTOR                                                    A 233
      YPC=YPC*FACTOR                                                    A 234
      XPCSTO=XPC                                                        A 235
      YPCSTO=YPC                                                        A 236
      XPCI=XPC                                                          A 237
      YPCI=YPC                                                          A 238
      XPCSAV=XPC                                                        A 239
      YPCSAV=YPC                                                        A 240
      TWON=2.*N                                                         A 241
      DO 34 I=1,N                                                       A 242
      XX(I)=X(I)                                                        A 243
34    YY(I)=Y(I)                                                        A 244
      DO 35 I=1,N                                                       A 245
35    X(I)=X(I)+RN*SXY                                                  A 246
      DO 36 I=1,N                                                       A 247
36    Y(I)=Y(I)+RN*SXY                                                  A 248
      WRITE (6,95)                                                      A 249
      DO 37 I=1,N                                                       A 250
      WRITE (LINE,94) IDENT(I),X(I),Y(I)                                A 251
37    CALL PRT (LINE,LEN_TRIM(LINE))
      DO 38 I=1,N                                                       A 252
      X(I)=X(I)*FACTOR                                                  A 253
38    Y(I)=Y(I)*FACTOR                                                  A 254
      IF (IRUN) 42,42,39                                                A 255
39    GO TO (45,40), IFOCFG                                             A 256
40    CC=CC+DELFF                                                       A 257
      XPC=XPCSAV                                                        A 258
      YPC=YPCSAV                                                        A 259
      XPCI=XPCSAV                                                       A 260
      YPCI=YPCSAV                                                       A 261
      DO 41 I=1,N                                                       A 262
      X(I)=XX(I)                                                        A 263
41    Y(I)=YY(I)                                                        A 264
42    IRUN=IRUN+1                                                       A 265
      IF (IRUNCO-IRUN) 43,45,45                                         A 266
43    IF (RUNFLG) 44,44,32                                              A 267
44    RUNFLG=1.                                                         A 268
      CC=CCI                                                            A 269
      DELFF=-DELFF                                                      A 270
      IRUN=0                                                            A 271
      GO TO 40                                                          A 272
45    CONTINUE                                                          A 273
      ICASE=1                                                           A 274
      ICASE=ICASE+1                                                     A 275
      ALPHA=ALPSAV                                                      A 276
      XOMEG=OMESAV                                                      A 277
      XKAP=XKASAV                                                       A 278
      ALPHAR=ALPHA/RAD                                                  A 279
      OMEGAR=XOMEG/RAD                                                  A 280
      XKAPR=XKAP/RAD                                                    A 281
      ILINE=0                                                           A 282
      SIGX=1.0                                                          A 283
      SIGY=1.0                                                          A 284
      NOPI=0                                                            A 285
      NOP2=0                                                            A 286
      EPOC=50.00                                                        A 287
      ICOUNT=0                                                          A 288
      ITER=1                                                            A 289
      JJ=1                                                              A 290
      SUM=0.0                                                           A 291
46    CONTINUE                                                          A 292
      IF (ICASE-1) 48,48,47                                             A 293
47    CONTINUE                                                          A 294
      IF (ITER-22) 50,48,48                                             A 295
48    SIG1=S1M*ALPHA+S1A                                                A 296
      SIG2=S2M*XOMEG+S2A                                                A 297
      SIG3=S3M*XKAP+S3A                                                 A 298
      IF (SIG1.LT.0.) SIG1=SIG1+360.                                    A 299
      IF (SIG1.GT.360.) SIG1=SIG1-360.                                  A 300
      IF (SIG2.LT.-180.) SIG2=SIG2+360.                                 A 301
      IF (SIG2.GT.180.) SIG2=SIG2-360.                                  A 302
      IF (SIG3.LT.0.) SIG3=SIG3+360.                                    A 303
      IF (SIG3.GT.360.) SIG3=SIG3-360.                                  A 304
      WRITE (6,96)                                                      A 305
      DO 49 I=1,N                                                       A 306
      WRITE (LINE,97) IDENT(I),X(I),Y(I),RR(I),DRR(I)                   A 307
49    CALL PRT (LINE,LEN_TRIM(LINE))
      CALL ALPBET (TI,ALFA,BETA,ETA,CVP,SIG2,SIG1,SIG3)                 A 308
      WRITE (6,98)                                                      A 309
      WRITE (LINE,99) IFRAM,TI,ALPHA,XOMEG,XKAP,XPC,YPC,SIG1,SIG2,SIG3, A 310
     1ALFA,BETA,ETA                                                     A 311
      CALL PRT (LINE,LEN_TRIM(LINE))
      WRITE (10) TI,SIG1,SIG2,SIG3,ALFA,BETA,ETA                        A 312
50    CONTINUE                                                          A 313
      SALPHA=SIN(ALPHAR)                                                A 314
      CALPHA=COS(ALPHAR)                                                A 315
      SOMEGA=SIN(OMEGAR)                                                A 316
      COMEGA=COS(OMEGAR)                                                A 317
      SKAPPA=SIN(XKAPR)                                                 A 318
      CKAPPA=COS(XKAPR)                                                 A 319
      AAC=-CALPHA*CKAPPA-SALPHA*SOMEGA*SKAPPA                           A 320
      BBC=SALPHA*CKAPPA-CALPHA*SOMEGA*SKAPPA                            A 321
      CCC=COMEGA*SKAPPA                                                 A 322
      AACP=CALPHA*SKAPPA-SALPHA*SOMEGA*CKAPPA                           A 323
      BBCP=-SALPHA*SKAPPA-CALPHA*SOMEGA*CKAPPA                          A 324
      CCCP=COMEGA*CKAPPA                                                A 325
      DDC=SALPHA*COMEGA                                                 A 326
      EEC=CALPHA*COMEGA                                                 A 327
      FFC=SOMEGA                                                        A 328
      IF (ICASE-1) 52,52,51                                             A 329
51    CONTINUE                                                          A 330
      IF (ITER-22) 53,52,52                                             A 331
52    CONTINUE                                                          A 332
      WRITE (6,100)                                                     A 333
53    CONTINUE                                                          A 334
      J=0                                                               A 335
54    J=J+1                                                             A 336
      XMC=AAC*XLAM(J)+BBC*XMU(J)+CCC*XNU(J)                             A 337
      XNC=AACP*XLAM(J)+BBCP*XMU(J)+CCCP*XNU(J)                          A 338
      QC=DDC*XLAM(J)+EEC*XMU(J)+FFC*XNU(J)                              A 339
      XMM(J)=XMC/QC                                                     A 340
      XNN(J)=XNC/QC                                                     A 341
      QQ(J)=CC/QC                                                       A 342
      XX1=SQRT((X(J)-XPCSTO)**2+(Y(J)-YPCSTO)**2)                       A 343
      RR(J)=XX1                                                         A 344
      CALL FTLUP (XX1,DELR,1,25,XRR,RRR)                                A 345
      DELR=-DELR/1000.                                                  A 346
      DRR(J)=DELR                                                       A 347
C     D1 AT THE FRAME CENTRE THE CORRECTION IS ZERO, NOT INDEFINITE
      DISTR=1.
      IF (XX1.NE.0.) DISTR=1.-DELR/XX1                                  A 348
      EPS(1,J)=DISTR*(X(J)-XPC)-CC*XMM(J)                               A 349
      EPS(2,J)=DISTR*(Y(J)-YPC)-CC*XNN(J)                               A 350
      DXY(J)=SQRT(EPS(1,J)**2+EPS(2,J)**2)                              A 351
      CM(J)=CC*XMM(J)                                                   A 352
      CN(J)=CC*XNN(J)                                                   A 353
      IF (ICASE-1) 56,56,55                                             A 354
55    CONTINUE                                                          A 355
      IF (ITER-22) 57,56,56                                             A 356
56    CONTINUE                                                          A 357
      WRITE (LINE,101) EPS(1,J),EPS(2,J),IDENT(J)                       A 358
      CALL PRT (LINE,LEN_TRIM(LINE))
57    IF (ITER.LE.1) SUM=SUM+EPS(1,J)*EPS(1,J)+EPS(2,J)*EPS(2,J)        A 359
C     R12 58, NOT 56
      IF (N-J) 58,58,54                                                 A 360
58    CONTINUE                                                          A 361
      ILINE=ILINE+6+N                                                   A 362
      IF (ILINE.GE.45) ILINE=0                                          A 363
      JJ=1                                                              A 364
      IF (ITER.LE.1) XXN=N                                              A 365
      DO 62 J=1,N                                                       A 366
      IF (J-NG(JJ)) 59,59,60                                            A 367
59    JJ=JJ+1                                                           A 368
      GO TO 62                                                          A 369
60    IF (ABS(EPS(1,J))-V) 61,61,63                                     A 370
61    IF (ABS(EPS(2,J))-V) 62,62,63                                     A 371
62    CONTINUE                                                          A 372
      WRITE (6,102) ((EPS(M,MM),M=1,2),MM=1,N)                          A 373
      WRITE (6,103)                                                     A 374
      GO TO 21                                                          A 375
63    DO 64 I=1,3                                                       A 376
      C(I,1)=0.0                                                        A 377
      DO 64 K=1,3                                                       A 378
      XN(I,K)=0.0                                                       A 379
64    CONTINUE                                                          A 380
      JJ=1                                                              A 381
      DO 70 J=1,N                                                       A 382
      IF (J-NG(JJ)) 66,65,66                                            A 383
65    JJ=JJ+1                                                           A 384
      GO TO 70                                                          A 385
66    FF1=AAC-DDC*XMM(J)                                                A 386
      FF2=BBC-EEC*XMM(J)                                                A 387
      FF3=CCC-FFC*XMM(J)                                                A 388
      FB1=AACP-DDC*XNN(J)                                               A 389
      FB2=BBCP-EEC*XNN(J)                                               A 390
      FB3=CCCP-FFC*XNN(J)                                               A 391
      GG1=XMM(J)*COMEGA+FFC*SKAPPA                                      A 392
      GB1=XNN(J)*COMEGA+FFC*CKAPPA                                      A 393
C     XMU(1), NOT XMU(J), IS THE PROGRAM'S OWN SLIP
      HM1=XLAM(J)*SALPHA+XMU(1)*CALPHA                                  A 394
      S1=-FF2*XLAM(J)+FF1*XMU(J)                                        A 395
      S2=FF3*HM1+GG1*XNU(J)                                             A 396
      SB1=-FB2*XLAM(J)+FB1*XMU(J)                                       A 397
      SB2=FB3*HM1+GB1*XNU(J)                                            A 398
      B(1,1)=S1*QQ(J)                                                   A 399
      B(1,2)=S2*QQ(J)                                                   A 400
      B(1,3)=-CC*XNN(J)                                                 A 401
      B(2,1)=SB1*QQ(J)                                                  A 402
      B(2,2)=SB2*QQ(J)                                                  A 403
      B(2,3)=CC*XMM(J)                                                  A 404
C     R13 SUBSCRIPTS I
      DO 67 I=1,3                                                       A 405
      BS(I,1)=B(1,I)                                                    A 406
      BS(I,2)=B(2,I)                                                    A 407
67    CONTINUE                                                          A 408
      DO 69 I=1,3                                                       A 409
      DO 68 L=1,2                                                       A 410
      C(I,1)=C(I,1)+BS(I,L)*(-EPS(L,J))                                 A 411
68    CONTINUE                                                          A 412
      DO 69 K=1,3                                                       A 413
      DO 69 L=1,2                                                       A 414
      XN(I,K)=XN(I,K)+BS(I,L)*B(L,K)                                    A 415
      XNTEMP(I,K)=XN(I,K)+BS(I,L)*B(L,K)                                A 416
69    CONTINUE                                                          A 417
70    CONTINUE                                                          A 418
      J1=3                                                              A 419
      J2=1                                                              A 420
      CALL MATINV (XN(1,1),J1,C(1,1),J2,DETERM,IPIVOT,INDEX,6,ISCALE)   A 421
      DO 71 I=1,3                                                       A 422
      DO 71 J=1,3                                                       A 423
71    XNUNIT(I,J)=0.                                                    A 424
      DO 72 I=1,3                                                       A 425
      DO 72 K=1,3                                                       A 426
      DO 72 J=1,3                                                       A 427
72    XNUNIT(I,K)=XN(I,J)*XNTEMP(J,K)+XNUNIT(I,K)                       A 428
      ALPHAR=ALPHAR+C(1,1)                                              A 429
      OMEGAR=OMEGAR+C(2,1)                                              A 430
      XKAPR=XKAPR+C(3,1)                                                A 431
      IF (XKAPR.LT.0.) XKAPR=XKAPR+TWOPI                                A 432
      IF (ALPHAR.LT.0.) ALPHAR=ALPHAR+TWOPI                             A 433
      IF (OMEGAR.LT.-PI) OMEGAR=OMEGAR+TWOPI                            A 434
      IF (XKAPR.GT.TWOPI) XKAPR=XKAPR-TWOPI                             A 435
      IF (ALPHAR.GT.TWOPI) ALPHAR=ALPHAR-TWOPI                          A 436
      IF (OMEGAR.GT.PI) OMEGAR=OMEGAR-TWOPI                             A 437
      ALPHA=ALPHAR*RAD                                                  A 438
      XOMEG=OMEGAR*RAD                                                  A 439
      XKAP=XKAPR*RAD                                                    A 440
      ITER=ITER+1                                                       A 441
      ICOUNT=ICOUNT+1                                                   A 442
      IF (ICOUNT-21) 46,46,73                                           A 443
73    SUM=0.                                                            A 444
      DO 74 J=1,N                                                       A 445
74    SUM=SUM+EPS(1,J)**2+EPS(2,J)**2                                   A 446
      SUM=SQRT(SUM/TWON)                                                A 447
      WRITE (LINE,104) SUM                                              A 448
      CALL PRT (LINE,LEN_TRIM(LINE))
C     DEGREES AGAINST RADIANS, THE PROGRAM'S OWN SLIP
      ALPHAP=ALPHA                                                      A 449
      XOMEGP=XOMEG                                                      A 450
      XKAPP=XKAP                                                        A 451
      IF (ALPHAP.LT.0..OR.ALPHAP.GT.TWOPI) ALPHAP=ALPHAI                A 452
      IF (XKAPP.LT.0..OR.XKAPP.GT.TWOPI) XKAPP=XKAPI                    A 453
      IF (XOMEGP.LT.-PI.OR.XOMEGP.GT.PI) XOMEGP=XOMEGI                  A 454
C     D2 A FRAME THAT ENDED IN NAN DOES NOT SPOIL THE NEXT
      IF (ALPHAP.NE.ALPHAP) ALPHAP=ALPHAI
      IF (XKAPP.NE.XKAPP) XKAPP=XKAPI
      IF (XOMEGP.NE.XOMEGP) XOMEGP=XOMEGI
      GO TO (21,40), IFOCFG                                             A 455
13    WRITE (6,105)                                                     A 456
      STOP                                                              A 457
76    FORMAT (2F10.3)                                                   A 459
77    FORMAT (A80)                                                      A 460
78    FORMAT (2I5,6F5.0)                                                A 462
79    FORMAT (3F10.1)                                                   A 463
80    FORMAT (16I5)                                                     A 464
81    FORMAT (1I5,1F10.1)                                               A 465
82    FORMAT (8F10.1)                                                   A 466
83    FORMAT (1I10,5F10.2)                                              A 467
84    FORMAT (7I5)                                                      A 468
85    FORMAT (1I5/(7I5))                                                A 469
86    FORMAT (8X,1I2,30X,1F7.3,3X,1F7.3,6X,1I4)                         A 470
C     M12 EIGHT SIGNIFICANT DIGITS, AS E13.7 KEPT THEM IN 1974
87    FORMAT (1I5,1P,2E15.7)                                            A 471
88    FORMAT (///6X,5HFRAME,1I4,26HIGNORED BY USERS DIRECTION)          A 472
89    FORMAT (/1X,'L-MARK LONGITUDE  LAT-GOCN RAD ER KM  LAT-GODT  ALTITA 473
     1UDE-FT    XLAM       XMU       XNU')                              A 474
90    FORMAT (1I5,2X,26HIGNORED BY USERS DIRECTION)                     A 475
91    FORMAT (1I5,2X,2F10.5,1F10.3,1F10.5,1F11.3,3F10.7)                A 476
92    FORMAT (1H0,'VEHICLE        X         Y         Z     XPC       YPA 477
     1C      CC')                                                       A 4771
93    FORMAT (7X,3F10.2,3F10.5)                                         A 478
94    FORMAT (1I4,2F15.8)                                               A 479
95    FORMAT (1H0,32H L-MARK  XCO FINAL     YCO FINAL)                  A 480
96    FORMAT (1H0,'L-MARK',8X,1HX,14X,1HY,11X,6HR DIST,9X,7HDELTA R)    A 481
97    FORMAT (1H ,1I3,4F15.5)                                           A 482
98    FORMAT (1H0,' FRAME   TIME     SIG1     SIG2     SIG3     XP     YA 483
     1P        PSI      THETA      PHI   ALPHA    BETA     ETA')        A 4831
99    FORMAT (1I5,4F9.3,2F7.3,2F11.3,1F9.3,3F8.3)                       A 484
100   FORMAT (1H0,47H RESIDUALS  RX(I)           RY(I)        L-MARK)   A 485
101   FORMAT (2X,2F16.8,1I10)                                           A 486
C     M12 ONE DIGIT BEFORE THE POINT, AS IN 1974
102   FORMAT (//1P,2E21.8)                                              A 487
103   FORMAT (///11H END OF JOB)                                        A 488
104   FORMAT (1H0,8X,31HSTANDARD DEVIATION OF RESIDUALS,1F13.5)         A 489
105   FORMAT (//,1X,11HEND OF CASE)                                     A 490
      END                                                               A 491
      SUBROUTINE TGTCAM (NC,NJ,RZ,PHIZ,THZ,TXYZT,TGTTAB)                B   1
      PARAMETER (MLF=100)
      DIMENSION A(3,3), XYZTAB(3,1), XSYSZS(3,1), TGTTAB(MLF,3), B(3,3),B   2
     1DXYZJ(3,1), DXYZJP(3,1), AMV(3,1), AMVB(3,1), DELJPT(MLF,3), TXYZTB   3
     2(20,4)                                                            B   4
      DIMENSION ATAB(MLF), AMUTAB(MLF), VTAB(MLF)                       B   5
      COMMON /DIRCOS/ ATAB,AMUTAB,VTAB                                  B   6
      DPR=57.29577951                                                   B   7
      COSPZ=COS(PHIZ)                                                   B   8
      COSTHZ=COS(THZ)                                                   B   9
      SINPZ=SIN(PHIZ)                                                   B  10
      SINTHZ=SIN(THZ)                                                   B  11
      XZ=RZ*COSPZ*COSTHZ                                                B  12
      YZ=RZ*COSPZ*SINTHZ                                                B  13
      ZZ=RZ*SINPZ                                                       B  14
      XSYSZS(1,1)=XZ                                                    B  15
      XSYSZS(2,1)=YZ                                                    B  16
      XSYSZS(3,1)=ZZ                                                    B  17
      A(1,1)=-SINTHZ                                                    B  18
      A(1,2)=-SINPZ*COSTHZ                                              B  19
      A(1,3)=+COSPZ*COSTHZ                                              B  20
      A(2,1)=COSTHZ                                                     B  21
      A(2,2)=-SINPZ*SINTHZ                                              B  22
      A(2,3)=SINTHZ*COSPZ                                               B  23
      A(3,1)=0.                                                         B  24
      A(3,2)=COSPZ                                                      B  25
      A(3,3)=SINPZ                                                      B  26
      INC=0                                                             B  27
1     INC=INC+1                                                         B  28
      TI=TXYZT(INC,1)                                                   B  29
      XYZTAB(1,1)=TXYZT(INC,2)                                          B  30
      XYZTAB(2,1)=TXYZT(INC,3)                                          B  31
      XYZTAB(3,1)=TXYZT(INC,4)                                          B  32
      TGTFLG=0.                                                         B  33
      INJ=0                                                             B  34
2     INJ=INJ+1                                                         B  35
      THJD=TGTTAB(INJ,1)                                                B  36
      PHIJD=TGTTAB(INJ,2)                                               B  37
      RJ=TGTTAB(INJ,3)                                                  B  38
      THJ=THJD/DPR                                                      B  39
      PHIJ=PHIJD/DPR                                                    B  40
      IF (TGTFLG) 3,3,5                                                 B  41
3     CONTINUE                                                          B  42
      TGTFLG=1.                                                         B  43
      DO 4 I=1,3                                                        B  44
      DO 4 J=1,3                                                        B  45
4     XSYSZS(I,1)=A(I,J)*XYZTAB(J,1)+XSYSZS(I,1)                        B  46
      XS=XSYSZS(1,1)                                                    B  47
      YS=XSYSZS(2,1)                                                    B  48
      ZS=XSYSZS(3,1)                                                    B  49
      TEMP=XS**2+YS**2                                                  B  50
      TEMP=SQRT(TEMP)                                                   B  51
      AL=ATAN2(ZS,TEMP)                                                 B  52
      ALPT=AL*DPR                                                       B  53
      T=ATAN2(YS,XS)                                                    B  54
      TPT=T*DPR                                                         B  55
      TEMP=XS**2+YS**2+ZS**2                                            B  56
      R=SQRT(TEMP)                                                      B  57
      SINT=SIN(T)                                                       B  58
      COST=COS(T)                                                       B  59
      SINAL=SIN(AL)                                                     B  60
      COSAL=COS(AL)                                                     B  61
      B(1,1)=-SINT                                                      B  62
      B(1,2)=COST                                                       B  63
      B(1,3)=0.                                                         B  64
      B(2,1)=-SINAL*COST                                                B  65
      B(2,2)=-SINAL*SINT                                                B  66
      B(2,3)=COSAL                                                      B  67
      B(3,1)=COSAL*COST                                                 B  68
      B(3,2)=SINT*COSAL                                                 B  69
      B(3,3)=SINAL                                                      B  70
5     CONTINUE                                                          B  71
      COSPJ=COS(PHIJ)                                                   B  72
      COSTHJ=COS(THJ)                                                   B  73
      SINPJ=SIN(PHIJ)                                                   B  74
      SINTHJ=SIN(THJ)                                                   B  75
      XJ=RJ*COSPJ*COSTHJ                                                B  76
      YJ=RJ*COSPJ*SINTHJ                                                B  77
      ZJ=RJ*SINPJ                                                       B  78
      DELXJ=XJ-XS                                                       B  79
      DELYJ=YJ-YS                                                       B  80
      DELZJ=ZJ-ZS                                                       B  81
      DELJPT(INJ,1)=DELXJ                                               B  82
      DELJPT(INJ,2)=DELYJ                                               B  83
      DELJPT(INJ,3)=DELZJ                                               B  84
      TEMP=DELXJ**2+DELYJ**2+DELZJ**2                                   B  85
      DELRJ=SQRT(TEMP)                                                  B  86
      AMV(1,1)=DELXJ/DELRJ                                              B  87
      AMV(2,1)=DELYJ/DELRJ                                              B  88
      AMV(3,1)=DELZJ/DELRJ                                              B  89
      DO 6 I=1,3                                                        B  90
      AMVB(I,1)=0.                                                      B  91
      DO 6 J=1,3                                                        B  92
6     AMVB(I,1)=B(I,J)*AMV(J,1)+AMVB(I,1)                               B  93
      DXYZJ(1,1)=DELXJ                                                  B  94
      DXYZJ(2,1)=DELYJ                                                  B  95
      DXYZJ(3,1)=DELZJ                                                  B  96
      DO 7 I=1,3                                                        B  97
      DXYZJP(I,1)=0.                                                    B  98
      DO 7 J=1,3                                                        B  99
7     DXYZJP(I,1)=B(I,J)*DXYZJ(J,1)+DXYZJP(I,1)                         B 100
      ATAB(INJ)=AMVB(1,1)                                               B 101
      AMUTAB(INJ)=AMVB(2,1)                                             B 102
      VTAB(INJ)=AMVB(3,1)                                               B 103
      IF (NJ-INJ) 8,8,2                                                 B 104
8     CONTINUE                                                          B 105
      DJPTFG=0.                                                         B 106
      DJPTFG=1.                                                         B 107
      IF (DJPTFG) 9,9,11                                                B 108
9     WRITE (6,14)                                                      B 109
      DO 10 INJ=1,NJ                                                    B 110
10    WRITE (6,13) (DELJPT(INJ,K),K=1,3)                                B 111
11    CONTINUE                                                          B 112
      IF (NC-INC) 12,12,1                                               B 113
12    RETURN                                                            B 114
C                                                                       B 115
13    FORMAT (1H0,5X,7E15.7)                                            B 116
14    FORMAT (1H0,8X,9HDELTA X J,6X,9HDELTA Y J,6X,9HDELTA Z J)         B 117
      END                                                               B 118
      SUBROUTINE ALPBET (TIME,ALPHAD,BETAD,ETAD,CVP,THETA,PSI,PHI)      C   1
      PARAMETER (MTB=3000)
      COMMON /AB/ III,IWV,TX(MTB),VVX(MTB),VVY(MTB),VVZ(MTB),H(MTB),    C   2
     1ALT(MTB),VXO(MTB),VYO(MTB)                                        C   3
      DR=.0174532925                                                    C   4
      RD=57.29577951                                                    C   5
      CALL FTLUP (TIME,VX1,1,III,TX,VVX)                                C   6
      CALL FTLUP (TIME,VY1,1,III,TX,VVY)                                C   7
      CALL FTLUP (TIME,VZ1,1,III,TX,VVZ)                                C   8
      CALL FTLUP (TIME,Z,1,III,TX,H)                                    C   9
C     THE TABLES END IN THE LETTER O, THE VALUES IN THE DIGIT 0
      CALL FTLUP (Z,VX0,1,IWV,ALT,VXO)                                  C  10
      CALL FTLUP (Z,VY0,1,IWV,ALT,VYO)                                  C  11
      VZ0=0.                                                            C  12
      PSIR=PSI*DR                                                       C  13
      PHIR=PHI*DR                                                       C  14
      THETAR=THETA*DR                                                   C  15
      X1=SIN(PSIR)                                                      C  16
      X2=COS(PSIR)                                                      C  17
      X3=SIN(PHIR)                                                      C  18
      X4=COS(PHIR)                                                      C  19
      X5=SIN(THETAR)                                                    C  20
      X6=COS(THETAR)                                                    C  21
C     R14 X6*X1, NOT X5*X1, IN B1 AND B4
      B1=X6*X2*VX1+X6*X1*VY1-X5*VZ1                                     C  22
      B2=(X2*X5*X3-X1*X4)*VX1+(X2*X4+X1*X5*X3)*VY1+X6*X3*VZ1            C  23
      B3=(X2*X5*X4+X1*X3)*VX1+(X1*X5*X4-X2*X3)*VY1+X6*X4*VZ1            C  24
      B4=X6*X2*VX0+X6*X1*VY0-X5*VZ0                                     C  25
      B5=(X2*X5*X3-X1*X4)*VX0+(X2*X4+X1*X5*X3)*VY0+X6*X3*VZ0            C  26
      B6=(X2*X5*X4+X1*X3)*VX0+(X1*X5*X4-X2*X3)*VY0+X6*X4*VZ0            C  27
      UP=B1-B4                                                          C  28
      VP=B2-B5                                                          C  29
      WP=B3-B6                                                          C  30
      ALPHA=ATAN2(WP,UP)                                                C  31
      ETA=ATAN2((SQRT(VP**2+WP**2)),UP)                                 C  32
      BETA=ATAN2(VP,UP)                                                 C  33
      ALPHAD=ALPHA*RD                                                   C  34
      BETAD=BETA*RD                                                     C  35
      ETAD=ETA*RD                                                       C  36
      V2=UP*UP+VP*VP+WP*WP                                              C  37
      CVP=SQRT(V2)                                                      C  38
      RETURN                                                            C  39
      END                                                               C  40
      SUBROUTINE MATINV (A,N,B,M,DETERM,IPIVOT,INDEX,NMAX,ISCALE)
C     LANGLEY LIBRARY, WRITTEN FROM APPENDIX C.  JORDAN'S METHOD, TOTAL
C     PIVOTING.  DET(A) = DETERM * (1E100)**ISCALE.  A SINGULAR MATRIX
C     RETURNS AT ONCE WITH DETERM = 0 AND ISCALE = 0.
      DIMENSION A(NMAX,*), B(NMAX,*), IPIVOT(*), INDEX(NMAX,2)
      ISCALE=0
      R1=1.E100
      R2=1.E-100
      DETERM=1.
      DO 20 J=1,N
20    IPIVOT(J)=0
      DO 550 I=1,N
C     SEARCH FOR THE PIVOT ELEMENT, ROW BY ROW, THE FIRST OF EQUALS
      AMAX=0.
      DO 105 J=1,N
      IF (IPIVOT(J)-1) 60,105,60
60    DO 100 K=1,N
      IF (IPIVOT(K)-1) 80,100,80
80    IF (AMAX-ABS(A(J,K))) 85,100,100
85    IROW=J
      ICOLUM=K
      AMAX=ABS(A(J,K))
100   CONTINUE
105   CONTINUE
      IF (AMAX) 110,106,110
106   DETERM=0.
      ISCALE=0
      RETURN
110   IPIVOT(ICOLUM)=1
C     INTERCHANGE ROWS TO PUT THE PIVOT ELEMENT ON THE DIAGONAL
      IF (IROW-ICOLUM) 140,260,140
140   DETERM=-DETERM
      DO 200 L=1,N
      SWAP=A(IROW,L)
      A(IROW,L)=A(ICOLUM,L)
200   A(ICOLUM,L)=SWAP
      DO 250 L=1,M
      SWAP=B(IROW,L)
      B(IROW,L)=B(ICOLUM,L)
250   B(ICOLUM,L)=SWAP
260   INDEX(I,1)=IROW
      INDEX(I,2)=ICOLUM
      PIVOT=A(ICOLUM,ICOLUM)
      DETERM=DETERM*PIVOT
      IF (ABS(DETERM).LT.R1) GO TO 320
      DETERM=DETERM/R1
      ISCALE=ISCALE+1
320   IF (ABS(DETERM).GT.R2) GO TO 330
      DETERM=DETERM*R1
      ISCALE=ISCALE-1
C     DIVIDE THE PIVOT ROW BY THE PIVOT ELEMENT
330   A(ICOLUM,ICOLUM)=1.
      DO 350 L=1,N
350   A(ICOLUM,L)=A(ICOLUM,L)/PIVOT
      DO 370 L=1,M
370   B(ICOLUM,L)=B(ICOLUM,L)/PIVOT
C     REDUCE THE OTHER ROWS
      DO 550 L1=1,N
      IF (L1-ICOLUM) 400,550,400
400   T=A(L1,ICOLUM)
      A(L1,ICOLUM)=0.
      DO 450 L=1,N
450   A(L1,L)=A(L1,L)-A(ICOLUM,L)*T
      DO 500 L=1,M
500   B(L1,L)=B(L1,L)-B(ICOLUM,L)*T
550   CONTINUE
C     INTERCHANGE COLUMNS
      DO 710 I=1,N
      L=N+1-I
      IF (INDEX(L,1)-INDEX(L,2)) 630,710,630
630   IROW=INDEX(L,1)
      ICOLUM=INDEX(L,2)
      DO 705 K=1,N
      SWAP=A(K,IROW)
      A(K,IROW)=A(K,ICOLUM)
705   A(K,ICOLUM)=SWAP
710   CONTINUE
      RETURN
      END
      SUBROUTINE FTLUP (X,Y,M,N,VARI,VARD)
C     LANGLEY LIBRARY, WRITTEN FROM APPENDIX D.  ONLY M = 1 IS CALLED BY
C     VOPD.  S IS +1 FOR AN INCREASING TABLE AND -1 FOR A DECREASING ONE
      DIMENSION VARI(*), VARD(*)
      CHARACTER LINE*132
      IF (M.NE.0.AND.N.GT.1) GO TO 5
      Y=VARD(1)
      RETURN
5     S=SIGN(1,M)
      DO 10 I=2,N
      IF (S*(VARI(I)-VARI(I-1)).LE.0.) GO TO 100
10    CONTINUE
C     THE INTERVAL IS K TO K+1, THE END INTERVALS REACH TO INFINITY
      K=1
20    IF (K.EQ.N-1) GO TO 30
      IF (S*(X-VARI(K+1)).LT.0.) GO TO 30
      K=K+1
      GO TO 20
30    IF (IABS(M).EQ.2.AND.N.GT.2) GO TO 40
      Y=VARD(K)+(X-VARI(K))*(VARD(K+1)-VARD(K))/(VARI(K+1)-VARI(K))
      RETURN
C     PARABOLA THROUGH J, J+1, J+2, WHICH ARE THE INTERVAL AND ITS
C     NEARER NEIGHBOUR, THE RIGHT ONE OF EQUALS
40    J=K
      IF (J.EQ.N-1) J=N-2
      IF (K.EQ.1.OR.K.EQ.N-1) GO TO 50
      IF (ABS(X-VARI(K-1)).LT.ABS(VARI(K+2)-X)) J=K-1
50    D1=(VARD(J+1)-VARD(J))/(VARI(J+1)-VARI(J))
      D2=(VARD(J+2)-VARD(J+1))/(VARI(J+2)-VARI(J+1))
      Y=VARD(J)+(X-VARI(J))*(D1+(X-VARI(J+1))*(D2-D1)/(VARI(J+2)-VARI(J)
     1))
      RETURN
100   WRITE (6,101) I
      WRITE (6,102)
      DO 110 I=1,N,8
      L=MIN(I+7,N)
      WRITE (LINE,103) (VARI(J),J=I,L)
110   CALL PRT (LINE,1+15*(L-I+1))
      DO 120 I=1,N,8
      L=MIN(I+7,N)
      WRITE (LINE,103) (VARD(J),J=I,L)
120   CALL PRT (LINE,1+15*(L-I+1))
      STOP
101   FORMAT ('1TABLE BELOW OUT OF ORDER FOR FTLUP AT POSITION ',I5)
102   FORMAT (' TABLE IS STORED IN LOCATION 000000'/)
103   FORMAT (1X,8G15.8)
      END
      SUBROUTINE PRT (LINE,N)
C     M11 PRINTS N COLUMNS OF LINE, NO ZERO BEFORE THE POINT.  A FIELD'S
C     0. FOLLOWS A BLANK OR A MINUS, AND THE SIGN MOVES TO THE RIGHT.
      CHARACTER LINE*(*)
      DO 1 I=2,N-1
      IF (LINE(I:I+1).NE.'0.') GO TO 1
      IF (LINE(I-1:I-1).NE.' '.AND.LINE(I-1:I-1).NE.'-') GO TO 1
      LINE(I:I)=LINE(I-1:I-1)
      LINE(I-1:I-1)=' '
1     CONTINUE
      WRITE (6,2) LINE(1:N)
2     FORMAT (A)
      RETURN
      END
      SUBROUTINE FILES
C     M5 THE DECK IS COPIED FROM STANDARD INPUT TO CARDS OF 80 COLUMNS,
C     SO THAT EVERY BLANK IS THERE AND COUNTS AS A ZERO.
      CHARACTER CARD*80, TAPE*256
      CLOSE (5)
      OPEN (5,STATUS='SCRATCH',FORM='FORMATTED',BLANK='ZERO')
      OPEN (15,FILE='/dev/stdin',STATUS='OLD',ACTION='READ')
1     READ (15,3,END=2) CARD
      WRITE (5,3) CARD
      GO TO 1
2     CLOSE (15)
      REWIND 5
      OPEN (9,STATUS='SCRATCH',FORM='FORMATTED')
      CALL GET_ENVIRONMENT_VARIABLE ('VOPD_TAPE10',TAPE)
      IF (TAPE.EQ.' ') TAPE='tape10'
      OPEN (10,FILE=TAPE,FORM='UNFORMATTED',STATUS='REPLACE')
      RETURN
3     FORMAT (A80)
      END
